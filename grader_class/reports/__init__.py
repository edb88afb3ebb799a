"""Reports for the systems that grade on machines of their own."""
