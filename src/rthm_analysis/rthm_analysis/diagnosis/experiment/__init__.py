"""The test to run next: computed, so that it tells apart what the present recording cannot.

===============  ==============================================================================
``next_test``    what to do next after a diagnosis: `next_experiment`
``planning``     the input that tells hypotheses apart best: `plan_experiment`
``contrasts``    hypotheses that a finding leaves open where the search has left no rival
``rivals``       hypotheses that the search has left
``repeating``    the same test at another amplitude
``searching``    many trials, the best of them refined
``candidates``   inputs that are tried
``bounds``       how large they may be
``response``     how the linear loop answers to a load, and whether it is stable
``predicting``   what a hypothesis predicts of a trial
``closed``       the loop closed within the mechanics of the replay
``delays``       mean delays of the loop
``trials``       loads and initial motion of a test
``sentences``    a planned test in words
``advice``       what to do where no motion of the rig says more
===============  ==============================================================================
"""
