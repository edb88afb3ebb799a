"""The exercise thymio_package: a Thymio in xacro, looked at and not started."""
