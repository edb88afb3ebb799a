"""Reads and writes the memory of others by system calls: process_vm_readv, process_vm_writev."""

import ctypes
import struct

import known
from tools import achieved, call, command_line, processes

for pid in {known.BYSTANDER, *processes()}:
    if b"bystander" in command_line(pid) or pid == known.BYSTANDER:
        mine = ctypes.create_string_buffer(b"attacked", 64)
        here = ctypes.create_string_buffer(struct.pack("PN", ctypes.addressof(mine), 8))
        there = ctypes.create_string_buffer(struct.pack("PN", known.BYSTANDER_ADDRESS, 8))
        if call(311, pid, here, 1, there, 1, 0)[0] == 8:
            achieved("wrote by process_vm_writev", pid)
        if call(310, pid, here, 1, there, 1, 0)[0] == 8:
            achieved("read by process_vm_readv", mine.value)
