"""Calls that a controller never needs, each with arguments that do nothing."""

from tools import achieved, is_reached

CALLS = {
    "add_key": (248, 0, 0, 0, 0, 0),
    "keyctl": (250, 99),
    "bpf": (321, 99, 0, 0),
    "io_uring_setup": (425, 0, 0),
    "perf_event_open": (298, 0, 0, -1, -1, 0),
    "userfaultfd": (323, 0x10000000),
    "kexec_load": (246, 0, 0, 0, 0xFFFF),
    "init_module": (175, 0, 0, 0),
    "open_by_handle_at": (304, -1, 0, 0),
    "quotactl": (179, 0xFFFFFF, 0, 0, 0),
    "modify_ldt": (154, 99, 0, 0),
    "fanotify_init": (300, 0xFFFF, 0),
}
for name, (number, *words) in CALLS.items():
    if is_reached(number, *words):
        achieved("reached", name)
