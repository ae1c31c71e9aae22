"use strict";
// The order of drives by weights: the rule of drivesizer/results/sizing.py, operation by operation, so that both
// give the same order to the last digit. Plain data in, plain data out; the page is not looked at.

/** A figure of several drives as multiples of the least one; null stays null. */
function multiples(values) {
  const known = values.filter((value) => value !== null);
  const least = Math.min(...known), most = Math.max(...known.map(Math.abs)) || 1;
  return values.map((value) => (value === null ? null : least > 0 ? value / least : 1 + (value - least) / most));
}

/**
 * The order of drives by several figures with weights.
 *
 * figures: by name a list with a number for each drive, of which less is better, or null where it is unknown.
 * weights: by name a number of 0 or more; a figure without one does not count.
 * Gives order, numbers of the drives, the best first; score of each drive, null where nothing that counts is known;
 * lacking, how many figures of each count and are unknown. Those that lack fewer go first, then the smaller score,
 * then the earlier drive.
 */
function byWeights(figures, weights) {
  const names = Object.keys(figures), count = names.length ? figures[names[0]].length : 0;
  const total = Array(count).fill(0), share = Array(count).fill(0), lacking = Array(count).fill(0);
  for (const name of names) {
    const weight = weights[name] ?? 0;
    if (!(weight > 0)) continue;
    multiples(figures[name]).forEach((value, n) => {
      if (value === null) lacking[n] += 1;
      else {
        total[n] += weight * value;
        share[n] += weight;
      }
    });
  }
  const score = total.map((sum, n) => (share[n] > 0 ? sum / share[n] : null));
  const rank = score.map((value) => (value === null ? Infinity : Math.floor(value * 1e9 + 0.5)));
  const order = [...Array(count).keys()];
  order.sort((a, b) => lacking[a] - lacking[b] || (rank[a] === rank[b] ? a - b : rank[a] - rank[b]));
  return { order, score, lacking };
}
