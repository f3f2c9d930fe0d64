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
    std::int64_t events = 0;  ///< 0: not known how many
    bool promised = true;     ///< false: skipped because hivectl had not asked, as connections of live sources do
};

/// The edges from some outputs to one receiver, from now on.
class Losses {
public:
    /// @param now  what the drones of the outputs say once the receiver is registered
    Losses(std::string receiver, std::vector<hive::Endpoint> outputs, const std::vector<hive::StatusAnswer>& now);
    /// Since then.
    /// @param here  the receiver's end: what a sender counts as lost may have arrived all the same
    [[nodiscard]] std::vector<Loss> until(const std::vector<hive::StatusAnswer>& now,
                                          const std::vector<hive::InputStatus>& here = {}) const;

private:
    struct Look {  ///< at one output
        bool known = false;
        std::int64_t epoch = 0;      ///< of the drone: which run of it this is
        std::int64_t elsewhere = 0;  ///< emitted while the receiver was not registered
        hive::Ledger events{};
    };
    [[nodiscard]] Look look(const hive::Endpoint& output, const std::vector<hive::StatusAnswer>& now) const;

    std::string receiver_;
    std::vector<hive::Endpoint> outputs_;
    std::vector<Look> first_;  ///< one for each output
};

/// The losses of this application, which receives the outputs, from now on.
Losses losses_from_now(hive::Application& application, const std::vector<hive::Endpoint>& outputs);
std::vector<Loss> losses_until_now(const Losses& losses, hive::Application& application,
                                   const std::vector<hive::Endpoint>& outputs,
                                   const std::vector<hive::InputStatus>& here = {});
/// Is something missing that was promised? Nothing is promised of a live source unless its results come in order; all
/// is promised of a lossless one.
bool promise_broken(const hive::CollectCounts& counts, const std::vector<Loss>& losses, bool ordered, bool lossless);
/// "camera.image: 3 events, dropped by the sender: its queue was full".
std::string sentence(const Loss& loss);

}  // namespace hivectl
