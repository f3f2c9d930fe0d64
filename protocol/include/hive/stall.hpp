// Stall reasons in plain words.
#pragma once

#include <hive/status.hpp>

#include <string>
#include <string_view>

namespace hive {

/// "it waits for a receiver that was cut off, or has not come yet"; empty for Reason::none.
std::string_view sentence(Reason reason) noexcept;

/// Has the output sent nothing for a second although a receiver needs it?
bool stalls(const Status& status, const OutputStatus& output);

/// Why the drone, its outputs or its inputs are stalled: "image: it waits for a receiver that was cut off, or has not
/// come yet (s1.image)". Empty without a stall. A pause of less than a second is not a stall.
std::string stall_text(const Status& status);

}  // namespace hive
