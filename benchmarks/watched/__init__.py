"""What a dashboard costs the test that it shows: runs with one and without, in turn."""
