"""A component on a test bench: motion in, force out, and inputs that scale it, as the voltage of a damper.

================  ==============================================================================
``criteria``      every number that decides something
``recorded``      what was recorded, on an even grid
``motion``        the motion without noise, and its rate
``along``         the force of a law along a motion that is known
``shapes``        what the force may be made of: spring, damper, and the laws of the library
``fitting``       the best values of a model
``selecting``     which parts it has
``told``          its values with standard deviations
``result``        what was found
``words``         in sentences
``identify``      all of it, one after the other
================  ==============================================================================
"""

from rthm_analysis.component.identify import identify_component, identify_recordings
from rthm_analysis.component.recorded import Channels, ComponentTest, channels_of, component_test
from rthm_analysis.component.result import ComponentFinding

__all__ = [
    "Channels", "ComponentFinding", "ComponentTest", "channels_of", "component_test", "identify_component",
    "identify_recordings",
]  # fmt: skip
