"""One drive over one load cycle, for all that need it: current, heat, voltage, power and energy, each law once.

``evaluate(drives, cycle, level)`` gives figures for each drive and sample; load cases are one call each.

What goes in
    ``Drive``: a column of each figure, SI, of any shape that broadcasts to (drives,) or (drives, samples). A drive
    alone is an axis of length one; a nominal figure is one sample; both ends of a band are two.
    ``cycle``: duration (segments,), speed, acceleration and torque of the load (segments, 2) at both ends of raw
    segments, straight between them; with a last axis of samples where each has a cycle of its own. It repeats.

What comes out
    ``Figures``: the same shape. Times are from the cycle's start. Of places that differ by rounding alone the first.
    ``pieces``: over time, of one drive.

Signs and directions
    Speed and torque of the load before the belt: power to the load is above 0 where both have one sign. A segment
    drives or brakes by the mean of its ends, and rests where both speeds are 0; its speed has one sign. Current has the
    sign of the motor's torque, power into the motor or its stage is above 0, energy returned is counted above 0.
    Temperatures are rises over ambient [K].

Steady state
    Winding and housing are as warm as in a cycle that came ever again (periodic), the winding's resistance that of each
    moment. A segment in which anything changes is cut so finely that the winding follows the mean of each piece; power
    and energy are then exact, cut where current or voltage changes its sign. A winding that runs away has an infinite
    rise, and is held at its permitted one for everything else; one of unknown heat is held at a given rise (``held``).

Unknown
    NaN in a drive's figure makes NaN of what hangs on it; what a level leaves out is NaN too.

May import: physics, files, units, errors.
"""
