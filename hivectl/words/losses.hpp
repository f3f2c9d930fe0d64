// Events that hivectl missed, as counted by their senders.
#pragma once

#include <hive/application.hpp>

#include <string>
#include <vector>

namespace hivectl {

/// Missed events of one output, and why.
struct Loss {
    std::string from;  ///< "camera.image"
    std::string reason;
    std::int64_t events = 0;
    bool promised = true;  ///< false: skipped without a request, as usual for live sources
};

/// The losses of an application's inputs by their senders' counters.
/// @param here  its inputs: an event that a sender counts as lost may still have arrived
std::vector<Loss> losses_of(const std::string& receiver, const std::vector<hive::InputStatus>& here,
                            const std::vector<hive::StatusAnswer>& senders);
/// The losses of this application.
std::vector<Loss> losses_now(hive::Application& application, const std::vector<hive::InputStatus>& here);
/// Is a promised event missing? A live source promises nothing, unless its results are ordered; a lossless one promises
/// everything.
bool promise_broken(const hive::CollectCounts& counts, const std::vector<Loss>& losses, bool ordered, bool lossless);
/// "camera.image: 3 events, dropped by the sender: its queue was full".
std::string sentence(const Loss& loss);

}  // namespace hivectl
