"""The node graph against the clock and against the exact engine.

``python -m benchmarks.realtime --out PATH`` runs the paper's test in real time and twice in simulated time
as a user would with ``rthm run``, and judges both. The machine should have nothing else to do.

=================  ===============================================================
``measure``        runs, and what is read from them
``bare``           the messages of a test in a bare rclpy loop
``short_periods``  all clocks at 1 ms and faster, beside a bare loop
``compare``        a recording beside the exact engine; payloads of a recording
``judge``          figures beside what is asked of them
``table``          all of it as a page
=================  ===============================================================
"""
