"""Writes robots/frames.json: where yourdfpy and MuJoCo see the links of our robots.

    pip install yourdfpy mujoco && python tests/robot_py/second_opinions.py

The two are 400 MB together, so the tests do not install them: they hold ours against these numbers.
Done with yourdfpy 0.0.60 and MuJoCo 4.0.0. They are independent of each other, and this stops where
they disagree. (They do where a prismatic axis is not of length 1: yourdfpy takes it as it is,
MuJoCo and KDL do not.)
"""

import json
from pathlib import Path

import mujoco
import numpy as np
import yourdfpy

ROBOTS = Path(__file__).parent / "robots"
#: What each joint is given, and those of a robot that are in play.
POSITIONS = (0.0, 0.3, -0.2, 0.1, 1.9, -2.7, 0.05, 6.5)
MOVED = {
    "walker": ("swivel", "tilt", "periscope"),
    "arm": ("shoulder_pan", "shoulder_lift", "elbow", "wrist_bend", "wrist_turn", "wrist_roll"),
    "rover": ("left_wheel_joint", "right_wheel_joint", "lift", "palm_turn", "left_finger_joint"),
}
#: Fixed links are kept, and MuJoCo wants a picture of none.
COMPILER = (
    '<mujoco><compiler fusestatic="false" discardvisual="false" balanceinertia="true"/></mujoco>'
)


def main() -> None:
    answers = []
    for robot, joints in MOVED.items():
        for shift in range(3):
            positions = {
                joint: POSITIONS[(shift * 3 + number) % len(POSITIONS)]
                for number, joint in enumerate(joints)
            }
            seen, again = by_yourdfpy(robot, positions), by_mujoco(robot, positions)
            for link in again:
                assert np.abs(np.array(seen[link]) - again[link]).max() < 1e-12, (robot, link)
            answers.append({"robot": robot, "positions": positions, "frames": seen})
    text = json.dumps(answers).replace('{"robot"', '\n{"robot"').replace('"frames"', '\n "frames"')
    (ROBOTS / "frames.json").write_text(text + "\n")


def by_yourdfpy(robot: str, positions: dict[str, float]) -> dict[str, list[list[float]]]:
    urdf = yourdfpy.URDF.load(str(ROBOTS / f"{robot}.urdf"), load_meshes=False)
    urdf.update_cfg(positions)
    return {
        link: urdf.get_transform(link, urdf.base_link).tolist() for link in sorted(urdf.link_map)
    }


def by_mujoco(robot: str, positions: dict[str, float]) -> dict[str, np.ndarray]:
    text = (ROBOTS / f"{robot}.urdf").read_text()
    head, name, rest = text.partition(f'<robot name="{robot_name(text)}">')
    model = mujoco.MjModel.from_xml_string(head + name + COMPILER + rest)
    data = mujoco.MjData(model)
    for joint, position in with_gripper(robot, positions).items():
        data.joint(joint).qpos[0] = position
    mujoco.mj_kinematics(model, data)
    frames = {}
    for number in range(1, model.nbody):
        frame = np.eye(4)
        frame[:3, :3] = data.xmat[number].reshape(3, 3)
        frame[:3, 3] = data.xpos[number]
        frames[model.body(number).name] = frame
    return frames


def robot_name(text: str) -> str:
    return text.partition('<robot name="')[2].partition('"')[0]


def with_gripper(robot: str, positions: dict[str, float]) -> dict[str, float]:
    """MuJoCo makes an equality of a mimic, which only its solver heeds."""
    if robot != "rover":
        return positions
    return {**positions, "right_finger_joint": 0.9 * positions["left_finger_joint"] + 0.002}


if __name__ == "__main__":
    main()
