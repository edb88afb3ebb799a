"""The page that plays runs of turtlesim: films of them, and the page itself."""
