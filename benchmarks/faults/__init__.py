"""Every fault that a running test must survive, made on purpose.

``python -m benchmarks.faults --out docs/faults`` runs one test in real time for each, with a driver of
somebody else (`test/programs/driver.py`) in place of the plant, makes the fault, and judges how the test
ended. The tests take the same list.

==============  ===============================================================
``laboratory``  the driver, the spec with its limits, and runs with both
``ways``        how faults are made
``catalogue``   the list: each fault with its way, and how the test has to end
``attempt``     one test with one fault
``measure``     figures of it: command steps, speed of the motor, time to rest
``judge``       figures beside what is demanded
``page``        all of it as a page
==============  ===============================================================
"""
