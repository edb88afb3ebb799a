"""The kinds of lint findings: no error by itself, and seldom what was meant."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

#: Kind -> what it says of the name and the near one of a `grader.recording.LintFinding`.
KINDS: Final[Mapping[str, str]] = {
    "unread": (
        "self.NAME is set outside of __init__ and never read, NEAR is a little different and read"
    ),
    "local": (
        "NAME is set in a function and not read there, NEAR (self.NAME, or NAME of the "
        "module) is meant"
    ),
    "global": "NAME of the module is set and read in a function, without global",
    "uncalled": "the method or function NAME stands there without its brackets",
    "method": "self.NAME is set, and is a method, too",
    "without_self": "the method NAME has no self",
    "called": "the function NAME that was to be passed to NEAR is called at once",
    "class": "the class NAME is passed to NEAR, not an instance of it",
    "unsent": "a request of NAME is made, and nothing ever calls a service",
    "beside": "the module NAME that is not found lies beside, and its name is NEAR",
    "swallows": "an except in the callback NAME catches every error, and shows none",
    "no_message": "the callback NAME of a subscription takes none",
    "message_for_timer": (
        "the callback NAME of a timer takes a message, NEAR is heard for that of a "
        "subscription, too"
    ),
    "called_callback": "the callback NAME is called where NEAR is to get it",
    "awaits": "the callback NAME waits for an answer",
    "ends_before_spin": "NAME (shutdown) stands before a spin",
    "spins_once": "a spin_once in no loop",
    "spins_in_init": "a spin in an __init__",
    "class_kept": "the class NAME is assigned where a message is meant",
    "hides_class": "NAME is a class, and assigned to",
    "comma": "NAME is made a tuple by the comma at its end",
    "calls_itself": (
        "the function NAME calls itself, and ROS calls it (NEAR is ros), calls it after NEAR, "
        "or never ('')"
    ),
    "no_init": "a node is made, and nothing calls rclpy.init",
    "no_spin": "a node is made, and nothing spins it",
    "unused": "nothing uses the function NAME, which may be meant for NEAR (create_timer)",
    "never_set": "self.NAME is read and never set, at the __init__",
    "never_read": "self.NAME is set and never read",
    "constant": "the text NAME is assigned to something",
    "sets": "the field NAME of a message is set",
    "compared": "the comparison NAME is a statement",
    "always": "a condition is True",
    "adds_nothing": "NAME adds 0",
    "no_effect": "the expression NAME is a statement",
    "no_super": "the __init__ of the node NAME calls no other",
    "at_middle": "NAME (x, y, or one axis where a condition lacks the other) is compared with NEAR",
    "at_wall": (
        "the condition NAME tells that a wall is near, and NEAR is what is wrong with it: "
        "never, always or middle - it is true, corners - in these only, or walls that no "
        "condition tells"
    ),
    "stays": "NAME is tested, and is NEAR for ever",
    "waits": "the callback NAME calls NEAR, which waits for another",
    "same_colour": "the colour NAME stands elsewhere, too",
    "argument": "the field NAME gets the number NEAR from this line",
    "imports": "NAME comes from NEAR",
    "step": "see grader_diagnosis.lint.paths",
    "unreached": (
        "NEAR's first word was not reached, since NAME was not true, false, called or left "
        "behind (past), its second; the rest is what the condition's names stood for"
    ),
    "raises": "the exception NAME came to this line",
    "unspun": "nothing uses the node NAME, a NEAR",
    "late": "a lambda in a loop uses its variable NAME",
    "cancels": "NAME is a call that cancels something",
    "overrules": "the else of this if sets NAME again",
    "default": "NAME is an argument whose default is a time",
    "degrees": "NAME divides radians by degrees, or compares them",
    "grows": "the callback NEAR of a subscription adds to NAME",
    "plus": "`=+` for `+=`: NAME is set",
    "resets": "NAME is set anew each time, and added to",
    "sides": "the argument NAME is set from NEAR, the attribute of its name",
    "unpublished": "the message NAME is made and filled, and never sent",
    "other_text": "the text NAME is compared, and only NEAR, in other letters, is set",
    "twice": "NAME is set twice in a row",
    "shared": "the list NAME holds one object several times",
    "misnamed": "the method NAME is meant to be called NEAR",
    "elsewhere": "the module NAME is not there, and a file of its name is NEAR",
    "unstarted": "nothing starts the thread NAME",
    "heads": "NAME is the angle of a pose",
    "exits": "where NAME is true the program ends",
    "keeps": "NAME is kept for the next comparison",
    "holds": "NAME is once for all a dict with the keys NEAR, or a list with the indexes NEAR",
    "zero": "NAME is set to NEAR, and something is divided by it",
    "ends": "the generator NAME does",
    "misplaced": "the method NAME is defined in the function NEAR, or outside of all classes",
    "no_return": "what the function NEAR gives is used as NAME, and it returns nothing",
    "swapped": "the function NAME takes NEAR, and gets it in another order",
    "entry": "main() needs the arguments NEAR",
    "not_defined": "NAME is imported from a module of the submission's that defines only NEAR",
    "circular": "the file NAME imports this one, too, which uses it or not (unused)",
    "unanswered": "the callback NAME of a server gives no NEAR (response, result)",
    "quiet": "NAME logs what is not shown",
}
