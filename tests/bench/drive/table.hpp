// Tables as people and Markdown read them.
#pragma once

#include "records.hpp"

#include <string>
#include <vector>

namespace hive::bench {

using Cells = std::vector<std::string>;

/// The first column to the left, the others to the right.
void print_table(const Cells& head, const std::vector<Cells>& rows);

/// About three digits; "-" for nothing; "*" after what was disturbed.
std::string text_of(const std::optional<Figure>& figure);
/// Two digits after the point.
std::string ratio_text(const std::optional<Figure>& figure);
/// "26.0 / 123"
std::string pair_text(const std::optional<Figure>& p50, const std::optional<Figure>& p99);

}  // namespace hive::bench
