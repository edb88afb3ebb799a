import sys

from py_pubsub import listener, talker


def main():
    {'talker': talker, 'listener': listener}[sys.argv[1]].main()
