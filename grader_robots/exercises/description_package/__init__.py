"""The exercise description_package: a package that describes a robot, looked at and not started."""
