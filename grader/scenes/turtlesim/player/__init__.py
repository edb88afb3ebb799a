"""The page that plays runs of turtlesim: animations of them, and the page itself."""
