"""Where virtual time begins, and where it never gets."""

#: The run starts on 15 June 2025 at 15:06:40 UTC, 1000 s after the machine did.
EPOCH_NS = 1_750_000_000 * 10**9
BOOT_NS = 1000 * 10**9
#: No deadline [ns since the start of the run].
NEVER = 1 << 62
