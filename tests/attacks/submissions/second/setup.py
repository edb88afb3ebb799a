from setuptools import setup

FILES = [("share/two", ["turtle_controller.py"]), ("share/two/launch", ["launch/two.launch.py"])]
setup(
    name="two",
    py_modules=["waits"],
    data_files=FILES,
    entry_points={"console_scripts": ["waits = waits:main"]},
)
