// Chooses encodings.
#include <hive/event/encoding_choice.hpp>

#include <algorithm>

namespace hive::event {

EncodingChoice::EncodingChoice(const Port& output, const protocol::Registration& registration, Way way)
    : output_(output), accepts_(registration.accepts), always_(registration.options.encoding)
{
    if (!always_.empty())
        require_encoding(output, always_, registration.receiver, accepts_);
    else if (way == Way::network && registration.options.delivery == Delivery::data)
        always_ = preferred();
}

std::string EncodingChoice::preferred() const
{
    const auto found = std::ranges::find_if(
        output_.encodings, [&](const Encoding& encoding) { return types_fit(encoding.type, accepts_); });
    return found == output_.encodings.end() ? std::string() : found->word;
}

bool EncodingChoice::met_by(const Event& event, const std::string& encoding) const
{
    return encoding.find(':') == std::string::npos && event.type == encoding_named(output_.encodings, encoding).type;
}

std::string EncodingChoice::of(const Event& event)
{
    if (output_.encodings.empty() || event.body.empty())
        return {};
    fell_back_ = always_.empty() && !types_fit(event.type, accepts_);
    const auto encoding = fell_back_ ? preferred() : always_;
    return encoding.empty() || met_by(event, encoding) ? std::string() : encoding;
}

std::string EncodingChoice::word() const
{
    const auto encoding = fell_back_ ? preferred() : always_;
    return encoding.empty() ? as_it_is : encoding;
}

}  // namespace hive::event
