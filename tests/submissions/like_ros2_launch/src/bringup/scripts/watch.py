#!/usr/bin/env python3
"""A program that CMake installs."""

print("watching")
