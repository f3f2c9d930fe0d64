// Choosing encodings.
#include <hive/error.hpp>
#include <hive/event/encoding_choice.hpp>

#include <algorithm>

namespace hive::event {

EncodingChoice::EncodingChoice(const Encoder& encoder, const protocol::Registration& registration, Way way)
    : encoder_(encoder), accepts_(registration.accepts), always_(registration.options.encoding)
{
    if (!always_.empty())
        require_known(registration);
    else if (way == Way::network && registration.options.delivery == Delivery::data)
        always_ = preferred();
}

void EncodingChoice::require_known(const protocol::Registration& registration) const
{
    if (!encoder_)
        throw Error(Errc::invalid_argument,
                    "output " + registration.output + " knows no encodings; its events travel as they are");
    if (const auto type = encoder_.type(always_); !types_fit(type, accepts_))
        throw Error(Errc::type_mismatch, "output " + registration.output + " as " + always_ + " is " + type + ", but "
                                             + registration.receiver + " takes " + accepts_);
}

std::string EncodingChoice::preferred() const
{
    const auto found = std::ranges::find_if(
        encoder_.encodings, [&](const std::string& word) { return types_fit(encoder_.type(word), accepts_); });
    return found == encoder_.encodings.end() ? std::string() : *found;
}

bool EncodingChoice::met_by(const Event& event, const std::string& encoding) const
{
    return encoding.find(':') == std::string::npos && event.type == encoder_.type(encoding);
}

std::string EncodingChoice::of(const Event& event)
{
    if (!encoder_ || event.body.empty())
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
