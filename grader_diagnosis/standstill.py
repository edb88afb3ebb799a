"""Rules about programs that go no further, or end before anything happens."""

from __future__ import annotations

from typing import Any

from grader.exercise import Diagnosis
from grader.recording import NOT_THERE
from grader.recording.observations import SourceLine, Standstill
from grader.text import NOTHING, Message, joined, msg, shown
from grader_diagnosis.case import (
    Case,
    after,
    diagnosed,
    diagnosed_by,
    function,
    of_kind,
    sentences,
    since,
)

#: A program that comes to its end by itself before this has hardly spun [s].
_SOON_S = 5.0
#: A callback that lets so much time pass, so often, has no good reason. In real time a busy machine
#: may have.
_SLOW_S, _SLOW_REAL_S, _SLOW_TIMES = 0.04, 0.15, 3
#: Part of a run's remark on a program that computes without end.
_WITHOUT_WAITING = "without waiting for ROS"
#: Messages a second that no program sends that waits between them.
_FLOOD_PER_S = 500.0
#: Of a run so long [s], so few messages are hardly any.
_LONG_S, _LONG_IN_LOOP_S, _ONCE = 5.0, 1.0, 2
#: So much of a line of code, or of what was printed, is shown [characters].
_LONGEST_CODE = 60
_SPIN = msg(
    "Create the node, then call rclpy.spin(node): it handles messages and timers until the node "
    "ends."
)


def stuck_in_callback(case: Case) -> Diagnosis | None:
    """The program waits in a callback for what only another callback could bring."""
    stop = case.stop
    if stop is None or stop.kind != "callback":
        return None
    who = function(stop.place) or msg("a callback")
    cause = msg(
        "Your node is stuck in {who}{where}{since}: it waits in this callback{in_call}, and "
        "meanwhile no answer, message or timer is handled."
    )
    help_ = msg(
        "Do not wait in a callback: send the request by call_async(request), "
        "and go on without waiting for the answer."
    )
    if "Lock" in stop.call:
        help_ = msg(
            "The thread that has a lock cannot take it again: call what takes it outside of your "
            "`with`, or use threading.RLock()."
        )
    if "sleep" in stop.call:
        help_ = msg("Do not sleep in a callback: return, and let create_timer() call you later.")
    return _stuck("stuck_in_callback", cause, help_, stop, who=who)


def stuck_in_call(case: Case) -> Diagnosis | None:
    """The program waits in a call while nobody spins."""
    stop = case.stop
    if stop is None or stop.kind != "call":
        return None
    cause = msg(
        "Your program is stuck{since}{where}: it waits{in_call} while nobody spins "
        "the node, so nothing can reach it."
    )
    help_ = _SPIN
    if "Rate" in stop.call or "sleep" in stop.call:
        help_ = msg(
            "A Rate needs a node that spins: use create_timer() with a callback and "
            "rclpy.spin(node), or spin in another thread."
        )
    elif stop.call.startswith("Client."):
        help_ = msg(
            "Use call_async() and rclpy.spin_until_future_complete(node, future), "
            "or spin in another thread."
        )
    return _stuck("stuck_in_call", cause, help_, stop)


def endless_loop(case: Case) -> Diagnosis | None:
    stop = case.stop
    help_ = msg(
        "Nothing else of your node can happen while a loop runs. Let a timer "
        "(create_timer) call you again and again, or call rclpy.spin_once(node)"
        " in the loop."
    )
    if stop is not None and stop.kind == "loop":
        name = function(stop.place)
        inside = msg(" in {name}", name=name) if name else NOTHING
        cause = msg(
            "Your program never leaves a loop{inside}{where}: it repeats without waiting for "
            "anything{since}."
        )
        return _stuck("endless_loop", cause, help_, stop, inside=inside)
    if case.run.outcome == "stalled" and any(_WITHOUT_WAITING in str(f) for f in case.run.flags):
        cause = msg(
            "Your program computes without end: it used processor time, and never waited for ROS."
        )
        return Diagnosis("endless_loop", cause, help_)
    return None


def stays_in_init(case: Case) -> Diagnosis | None:
    """The program stays in a node's `__init__`, and never gets to what comes after it."""
    stop, observed = case.stop, case.observed
    if stop is None or stop.kind != "init" or stop.place is None:
        return None
    publishers = [end for end in observed.ends if end.kind == "publisher"]
    is_mute = bool(publishers) and not any(end.used for end in publishers)
    if not is_mute and never_spins(case) is None:
        return None
    cause = msg(
        "Your program never leaves __init__(): it stays at {code}{where}, and "
        "what comes after is never reached."
    )
    help_ = msg(
        "Let __init__ only make the publisher, the subscription and a timer, "
        "and return; main() then calls rclpy.spin(node), and create_timer() "
        "lets you act again and again."
    )
    if "spin(" in stop.place.text:
        help_ = msg(
            "spin() returns only when the program ends. In a loop of your own call "
            "rclpy.spin_once(self, timeout_sec=0.01) each time instead. Or: {other_help}",
            other_help=help_,
        )
    return diagnosed("stays_in_init", cause, help_, stop.place, code=_code(stop.place))


def spins_in_loop(case: Case) -> Diagnosis | None:
    """A loop that would send something calls spin() first, which does not return."""
    stop = case.stop
    publishers = [end for end in case.observed.ends if end.kind == "publisher"]
    if stop is None or stop.kind != "spin" or not publishers or any(e.used for e in publishers):
        return None
    cause = msg("A loop calls spin(), which returns only when the program ends.")
    if stop.place:
        cause = msg(
            "The loop around {code}{where} never repeats: spin() returns only when the program "
            "ends, and nothing after it is reached.",
            code=_code(stop.place),
        )
    help_ = msg(
        "In a loop of your own call rclpy.spin_once(node, timeout_sec=0.01) each time. Or let "
        "create_timer() call what the loop does, and call rclpy.spin(node) once, without a loop."
    )
    return diagnosed("spins_in_loop", cause, help_, stop.place)


def does_nothing(case: Case) -> Diagnosis | None:
    """The program ended without a publisher, a subscription or a client."""
    if case.ended_s is None or case.observed.ends or case.observed.spun_s is not None:
        return None
    ended = after(case.ended_s)
    for finding in of_kind(case, "misnamed"):
        if finding.near == "__init__":
            cause = msg(
                "Your program ended {after}, and nothing called {name}(){where}: Python looks for "
                "__init__().",
                after=ended,
            )
            help_ = msg("Write def {near}(...) there.")
            return diagnosed_by(finding, "does_nothing", cause, help_)
    cause = msg(
        "Your program ended {after} without a publisher, a subscription or a "
        "client: is main() ever called?"
    )
    help_ = msg("Let the file end with: if __name__ == '__main__': main()")
    return diagnosed("does_nothing", cause, help_, None, case.ended_s, after=ended)


def is_deaf(case: Case) -> Diagnosis | None:
    """The program never spins its node, which is to hear something or to get an answer."""
    is_to_hear = any(end.kind != "publisher" for end in case.observed.ends)
    return never_spins(case) if is_to_hear else None


def starts_what_is_not_there(case: Case) -> Diagnosis | None:
    """A launch file names a program that the set-up does not install."""
    for flag in case.run.flags:
        if flag.key == NOT_THERE.key:
            help_ = msg(
                "Write one of these names in the launch file, or add it to console_scripts."
            )
            return diagnosed("starts_what_is_not_there", joined([flag, "."]), help_)
    return None


def never_spins(case: Case) -> Diagnosis | None:
    """The program never spins its node, which waits for messages or timers."""
    observed = case.observed
    if not observed.is_known or observed.spun_s is not None:
        return None
    deaf = [end for end in observed.ends if end.kind == "subscription" and not end.used]
    sends = [end for end in observed.ends if end.kind == "publisher" and end.used]
    if not observed.ends or (sends and not deaf):
        return None
    none = msg("none of its subscriptions and timers is ever called")
    if not observed.timers and all("client" in end.kind for end in observed.ends):
        none = msg("no answer ever reaches it")
    place = deaf[0].place if deaf else None
    help_ = _SPIN
    cause = msg("Your program never spins its node, so {none}{where}.")
    if (loop := _loop_at_end(case)) is not None:
        place = loop
        help_ = msg(
            "Replace the loop by create_timer() with a callback, then call rclpy.spin(node): it "
            "handles messages and timers until the node ends."
        )
        cause = msg(
            "Your program stays in the loop {code}{where} and never spins its node, so {none}.",
            code=_code(loop),
        )
    elif case.ended_s is not None:
        cause = msg("Your program ended {after} and never spun its node, so {none}.")
        cause = cause.given(after=after(case.ended_s))
    return diagnosed("never_spins", cause, help_, place, case.ended_s, none=none)


def ends_early(case: Case) -> Diagnosis | None:
    """The program ended when it had hardly begun."""
    ended_s, observed = case.ended_s, case.observed
    if observed.ends and all("client" in end.kind and end.used for end in observed.ends):
        return None  # it has asked, and is done
    has_ended = case.run.outcome in ("exited", "finished") or case.is_shut_down
    if ended_s is None or ended_s > _SOON_S or not has_ended:
        return None
    if case.is_to_end and not case.run.exit_code:
        return None
    sent = sum(end.used for end in case.observed.ends if end.kind == "publisher")
    what = msg("nothing")
    if sent:
        what = msg("one message", "{n} messages", n=sent)
    if last := case.last_line:
        what = msg(
            "{what}, and the last that it printed is: {last!r}",
            what=what,
            last=shown(last, _LONGEST_CODE),
        )
    raised = case.observed.raised
    place = raised.place if raised is not None else None
    cause = msg("Your program ended {after}, by itself{where}; until then it had published {what}.")
    help_ = msg(
        "rclpy.spin_once(node) handles one message and returns: "
        "rclpy.spin(node) goes on. If it does spin, look for what ends it: "
        "shutdown(), sys.exit(), a loop that is left too soon."
    )
    words = {"after": after(ended_s), "what": what}
    return diagnosed("ends_early", cause, help_, place, ended_s, **words)


def slow_callback(case: Case) -> Diagnosis | None:
    """A callback lets time pass, again and again."""
    least_s = _SLOW_S if case.run.time == "virtual" else _SLOW_REAL_S
    slow = max(
        (s for s in case.observed.slow if s.longest_s >= least_s and s.times >= _SLOW_TIMES),
        key=lambda s: s.longest_s * s.times,
        default=None,
    )
    if slow is None:
        return None
    return diagnosed(
        "slow_callback",
        msg(
            "{who} takes up to {longest_s:.2g} s each time it is called{where}; meanwhile your "
            "node handles no message and no timer."
        ),
        msg(
            "Do not sleep or wait in a callback: do what is to be done now, and "
            "return. The next message comes by itself, and create_timer() calls you"
            " later."
        ),
        slow.place,
        who=function(slow.place) or msg("A callback"),
        longest_s=slow.longest_s,
    )


def publishes_without_waiting(case: Case) -> Diagnosis | None:
    """A loop publishes as fast as it can."""
    run_s = case.run.simulated_s
    for end in case.ends:
        rate = end.used / max(run_s, 1.0)
        if end.kind != "publisher" or not case.observed.is_known or rate < _FLOOD_PER_S:
            continue
        loop = _loop_at_end(case)
        cause = msg(
            "You published {sent} messages on {topic} in {run_s:.0f} s{where}: nothing in "
            "that loop waits."
        )
        if loop is not None:
            cause = msg(
                "You published {sent} messages on {topic} in {run_s:.0f} s: nothing in the loop "
                "{code}{where} waits.",
                code=_code(loop),
            )
        return diagnosed(
            "publishes_without_waiting",
            cause,
            msg(
                "A few commands a second are enough: publish in the callback of "
                "create_timer(), and let rclpy.spin(node) call it."
            ),
            loop or end.used_at or end.place,
            sent=end.used,
            topic=shown(end.name),
            run_s=run_s,
        )
    return None


def sends_too_much(case: Case) -> Diagnosis | None:
    """The program published so fast that the grader ended it; it has no exit code then."""
    is_ended = case.run.outcome == "killed" and case.run.exit_code is None
    return publishes_without_waiting(case) if is_ended else None


def hears_once(case: Case) -> Diagnosis | None:
    """The program received a topic once, though the scene publishes it all the time."""
    run_s = case.run.simulated_s
    loop = _loop_at_end(case)
    least_s = _LONG_S if loop is None else _LONG_IN_LOOP_S
    if not case.observed.is_known or case.ended_s is not None or run_s < least_s:
        return None
    published = {(e.name, e.type) for e in case.scene_has if e.kind == "publisher"}
    heard = [end for end in case.ends if end.kind == "subscription"]
    for end in heard:
        is_alone = sum(each.name == end.name for each in heard) == 1  # not one for each message
        asked_once = end.place is not None and "wait_for_message" in end.place.text
        if asked_once or not is_alone:
            continue
        if (end.name, end.type) in published and 0 < end.used <= _ONCE:
            cause = msg(
                "Your node received {topic} hardly more than once in {run_s:.0f} s{where}, "
                "though it is published all the time."
            )
            if loop is not None:
                cause = msg(
                    "Your node stays in the loop {code}{where}, so it received {topic} hardly "
                    "more than once in {run_s:.0f} s.",
                    code=_code(loop),
                )
            help_ = msg(
                "The next message is handled only after the callback has returned: don't wait "
                "in a loop there; let create_timer() call you."
            )
            if loop is None or function(loop) in ("", "main()"):
                more = msg("And rclpy.spin(node) has to go on meanwhile.")
                help_ = sentences(help_, more)
            words = {"topic": shown(end.name), "run_s": run_s}
            return diagnosed("hears_once", cause, help_, loop or end.place, **words)
    return None


def _loop_at_end(case: Case) -> SourceLine | None:
    """Return the loop that the main thread was in when the run ended."""
    stop = case.stop
    return stop.place if stop is not None and stop.kind == "going" else None


def _code(place: SourceLine) -> str:
    """Quote a line of code: '`while True:`'."""
    return f"`{shown(place.text, _LONGEST_CODE)}`"


def _stuck(key: str, cause: Message, help_: Message, stop: Standstill, **words: Any) -> Diagnosis:
    """Diagnose a program that goes no further; its cause may name `{since}` and `{in_call}`."""
    words["since"] = since(stop.time_s)
    words["in_call"] = msg(" in {call}()", call=shown(stop.call)) if stop.call else NOTHING
    return diagnosed(key, cause, help_, stop.place, stop.time_s, **words)
