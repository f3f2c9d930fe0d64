// What did not come to hivectl from the outputs that it receives, as their senders count it.
#pragma once

#include <hive/application.hpp>

#include <string>
#include <vector>

namespace hivectl {

/// Events of one output that did not come, and why.
struct Loss {
    std::string from;  ///< "camera.image"
    std::string reason;
    std::int64_t events = 0;
    bool promised = true;  ///< false: skipped because hivectl had not asked, as connections of live sources do
};

/// What the senders of an application's inputs say that did not come to it.
/// @param here  its inputs: what a sender counts as lost may have arrived all the same
std::vector<Loss> losses_of(const std::string& receiver, const std::vector<hive::InputStatus>& here,
                            const std::vector<hive::StatusAnswer>& senders);
/// The losses of this application.
std::vector<Loss> losses_now(hive::Application& application, const std::vector<hive::InputStatus>& here);
/// Is something missing that was promised? Nothing is promised of a live source unless its results come in order; all
/// is promised of a lossless one.
bool promise_broken(const hive::CollectCounts& counts, const std::vector<Loss>& losses, bool ordered, bool lossless);
/// "camera.image: 3 events, dropped by the sender: its queue was full".
std::string sentence(const Loss& loss);

}  // namespace hivectl
