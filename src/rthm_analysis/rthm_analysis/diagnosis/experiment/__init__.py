"""The test to run next: computed, so that it tells apart what the present recording cannot."""
