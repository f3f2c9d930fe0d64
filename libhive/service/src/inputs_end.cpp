// Compares what the connections say now with what they said before.
#include "inputs_end.hpp"

namespace hive::service {

void InputsEnd::look()
{
    auto now = event::end_of(module_.intakes(), true);
    if (now == end_)
        return;
    const bool before = end_.has_value();
    end_ = std::move(now);
    if (before)
        take_back();
    if (end_)
        inbox_.command(
            [this, text = *end_](Worker& worker) { worker.inputs_ended(text, [this] { return end_.has_value(); }); });
}

/// There is something to do again. Who was told of the end already gets what comes of it all the same.
void InputsEnd::take_back()
{
    for (auto& outlet : module_.outlets())
        if (outlet.carrier() == protocol::PacketType::event)
            outlet.go_on();
}

}  // namespace hive::service
