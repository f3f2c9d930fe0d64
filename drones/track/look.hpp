// Appearances of objects: histograms of colours, compared to decide whether two boxes may show the same object.
#pragma once

#include <optional>
#include <vector>

namespace track {

/// Parts of a whole, with a sum of 1; empty: not known.
using Look = std::vector<float>;

/// A look of non-negative numbers; empty if their sum is 0.
Look look_of(const std::vector<double>& numbers);

/// From 0, the same, to 1, nothing in common: the Hellinger distance, the root of 1 - (the sum of the roots of the
/// products). Nothing when one is not known, or they were made in different ways. Source: Comaniciu, Ramesh and Meer,
/// "Kernel-based object tracking" (2003).
std::optional<double> difference(const Look& a, const Look& b);

/// Moves `look` by this share (0 to 1) towards the observation; replaces an unknown one.
void follow(Look& look, const Look& seen, double share);

}  // namespace track
