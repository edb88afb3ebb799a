/* Finds a type's support for one middleware inside this extension module.
 *
 * ROS's own librosidl_typesupport_c opens a library "lib<package>__<type support>.so" for each
 * kind of type support, which must lie in LD_LIBRARY_PATH. Our extension module holds all kinds of
 * its package, so the symbol is looked up right here, in the same map that rosidl_typesupport_c
 * generates. building.py renames the two functions per package by macros, so that they never stand
 * in for ROS's own in the same process. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stddef.h>
#include <string.h>

#include "rosidl_runtime_c/message_type_support_struct.h"
#include "rosidl_runtime_c/service_type_support_struct.h"
#include "rosidl_typesupport_c/message_type_support_dispatch.h"
#include "rosidl_typesupport_c/service_type_support_dispatch.h"
#include "rosidl_typesupport_c/type_support_map.h"

/* The function that returns the type support called `identifier`, or NULL. */
static void * find_symbol(const type_support_map_t * map, const char * identifier)
{
  static void * this_module = NULL;
  Dl_info info;
  if (!this_module && dladdr((void *)&find_symbol, &info)) {
    /* Python loads modules RTLD_LOCAL: a handle of our own is the only way to our symbols. */
    this_module = dlopen(info.dli_fname, RTLD_NOW | RTLD_NOLOAD);
  }
  if (!this_module) {
    return NULL;
  }
  for (size_t i = 0; i < map->size; ++i) {
    if (0 == strcmp(map->typesupport_identifier[i], identifier)) {
      return dlsym(this_module, map->symbol_name[i]);
    }
  }
  return NULL;
}

const rosidl_message_type_support_t *
rosidl_typesupport_c__get_message_typesupport_handle_function(
  const rosidl_message_type_support_t * handle, const char * identifier)
{
  typedef const rosidl_message_type_support_t * (*getter)(void);
  if (0 == strcmp(handle->typesupport_identifier, identifier)) {
    return handle;
  }
  getter get = (getter)find_symbol((const type_support_map_t *)handle->data, identifier);
  return get ? get() : NULL;
}

const rosidl_service_type_support_t *
rosidl_typesupport_c__get_service_typesupport_handle_function(
  const rosidl_service_type_support_t * handle, const char * identifier)
{
  typedef const rosidl_service_type_support_t * (*getter)(void);
  if (0 == strcmp(handle->typesupport_identifier, identifier)) {
    return handle;
  }
  getter get = (getter)find_symbol((const type_support_map_t *)handle->data, identifier);
  return get ? get() : NULL;
}
