// Answers get and set.
#pragma once

#include "inbox.hpp"
#include "state_file.hpp"

namespace hive::service {

/// The network side; values are assigned by a command to the user thread.
class ParameterRequests {
public:
    ParameterRequests(const ParameterSet& parameters, event::Module& module, Inbox& inbox, StateFile& state_file)
        : parameters_(parameters), module_(module), inbox_(inbox), state_file_(state_file)
    {
    }

    void on_get(const event::Incoming& incoming) const;
    void on_set(const event::Incoming& incoming);

private:
    /// Any thread. Of the parameters that `wanted` names.
    [[nodiscard]] Json present_values(const Json& wanted) const;
    /// The user thread. Throws when the drone's code does not take the values.
    [[nodiscard]] Json apply(Worker& worker, const Json& values);

    const ParameterSet& parameters_;
    event::Module& module_;
    Inbox& inbox_;
    StateFile& state_file_;
};

}  // namespace hive::service
