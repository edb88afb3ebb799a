"""The class page: what a class has done, on one page that needs nothing beside it."""
