"""What an executor looks at: wait sets that are kept for as long as the entities are the same."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.event_handler import EventHandler
from rclpy.exceptions import InvalidHandle

from grader.run.lockstep import waitsets

#: A node's lists of entities, in rclpy's order within a wait set's kinds.
LISTS = ("_timers", "_subscriptions", "_guards", "_clients", "_services", "_Node__waitables")


class Look:
    """A wait set, and the entities that are in it."""

    def __init__(self, nodes: list[Any], is_wanted: Callable[[Any], bool], context: Any) -> None:
        self.wait_set = waitsets.WaitSet(context)
        #: handle -> its entity, the entity's node, what executors take from it
        self.by_handle: dict[Any, tuple[Any, Any, str]] = {}
        for kind, take, add in (
            ("timers", "_take_timer", self.wait_set.add_timer),
            ("subscriptions", "_take_subscription", self.wait_set.add_subscription),
            ("clients", "_take_client", self.wait_set.add_client),
            ("services", "_take_service", self.wait_set.add_service),
        ):
            for entity, node in _entered(nodes, kind, is_wanted, add):
                self.by_handle[entity.handle] = entity, node, take
        guards = _entered(nodes, "guards", is_wanted, self.wait_set.add_guard_condition)
        self.guards = [guard for guard, _ in guards]
        self.waitables = [w for node in nodes for w in node.waitables if is_wanted(w)]
        for waitable in self.waitables:
            try:
                with waitable:
                    waitable.add_to_wait_set(self.wait_set)
            except InvalidHandle:
                pass
        #: somebody is going through what was ready
        self.is_used = False
        self.only_events = all(type(w) is EventHandler for w in self.waitables)

    def may_have_waitables(self) -> bool:
        """Whether one of the waitables may be ready after a wait."""
        if not self.waitables:
            return False
        if not self.only_events or self.wait_set.has_events():
            return True
        for waitable in self.waitables:
            if waitable._ready_to_take_data:
                return True
        return False

    def may_have_work(self) -> bool:
        """Whether anything may be ready after a wait: an executor's own guard condition is none."""
        return bool(self.wait_set.take_ready() or self.guards) or self.may_have_waitables()


class View:
    """The entities of some nodes, and the look at all of them, for as long as they are the same."""

    def __init__(self, nodes: list[Any], context: Any) -> None:
        self._nodes = nodes
        self._lists = [
            (vars(node), name, list(getattr(node, name))) for node in nodes for name in LISTS
        ]
        self._entities = [entity for _, _, entities in self._lists for entity in entities]
        groups = {entity.callback_group for entity in self._entities}
        self._groups = [group for group in groups if type(group) is not ReentrantCallbackGroup]
        self._is_plain = all(type(g) is MutuallyExclusiveCallbackGroup for g in self._groups)
        self.look = Look(nodes, lambda _: True, context)

    def is_of(self, nodes: list[Any]) -> bool:
        """Whether these nodes still have these entities."""
        if nodes != self._nodes:
            return False
        for names, name, entities in self._lists:
            if names[name] != entities:
                return False
        for timer in self.look.wait_set.timers:
            if timer.is_gone:
                return False
        return True

    def all_can_execute(self) -> bool:
        """What `Executor.can_execute` says of every entity."""
        if not self._is_plain:
            return False
        for group in self._groups:
            if group._active_entity is not None:
                return False
        for entity in self._entities:
            if entity._executor_event:
                return False
        return True


def _entered(
    nodes: list[Any], kind: str, is_wanted: Callable[[Any], bool], add: Callable[[Any], int]
) -> list[tuple[Any, Any]]:
    """Add the nodes' entities of a kind to a wait set; those that still exist, with their nodes."""
    found = []
    for node in nodes:
        for entity in getattr(node, kind):
            if is_wanted(entity):
                try:
                    with entity.handle:
                        add(entity.handle)
                except InvalidHandle:
                    continue
                found.append((entity, node))
    return found
