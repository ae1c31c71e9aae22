"""Candidates to the best drives: stages of limits on columns, ranking, what would have to change where none passes.

Load, gearhead and motor are checked once per part, and a pair of which one fails is never made; combinations go by
moments, survivors by peaks, voltage and controller, the rest by the waveform. The motor's current is linear in six
functions of time with coefficients of the candidate alone, all of them 0 or more: RMS values are quadratic forms in one
6 x 6 matrix, peaks lie at the few points that no other exceeds in every function, and another belt ratio only scales
both. Safe bounds decide most; what they leave open, and all that is shown, is computed by the kernel, over very long
cycles in the order of the objective until enough pass. Where peers give a missing figure all candidates are examined at
the favourable end of its band, those with such a figure at the other too.

May import: equations, physics, catalog, loads, spec, results, load_cases, machine, control; not output.
"""

from __future__ import annotations
