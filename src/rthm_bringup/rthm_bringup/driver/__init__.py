"""Whether a driver of somebody else keeps to what ``docs/driver.md`` asks of it."""
