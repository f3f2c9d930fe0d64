// Passes the end of what the inputs receive on to the outputs (SPEC.md, section 5.6).
#pragma once

#include "inbox.hpp"

#include <hive/event/module.hpp>

namespace hive::service {

/// The network side.
class InputsEnd {
public:
    InputsEnd(event::Module& module, Inbox& inbox) : module_(module), inbox_(inbox) {}
    InputsEnd(const InputsEnd&) = delete;
    InputsEnd& operator=(const InputsEnd&) = delete;

    /// To be called when a connection of an input has changed.
    void look();

private:
    void take_back();

    event::Module& module_;
    Inbox& inbox_;
    std::optional<std::string> end_;  ///< what is said about it
};

}  // namespace hive::service
