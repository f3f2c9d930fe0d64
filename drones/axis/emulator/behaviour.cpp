// Keeps the settings in one table.
#include "behaviour.hpp"

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <variant>
#include <vector>

namespace axis::emulator {
namespace {

using Member = std::variant<int Behaviour::*, bool Behaviour::*, std::string Behaviour::*>;

struct Word {
    const char* name;
    Member member;
    std::vector<std::string> choices = {};
};

const std::vector<Word>& words()
{
    using B = Behaviour;
    static const std::vector<Word> table{{"fps", &B::fps},
                                         {"step", &B::step},
                                         {"auth", &B::auth, {"none", "basic", "digest", "basic_digest"}},
                                         {"qop", &B::qop},
                                         {"nonce_uses", &B::nonce_uses},
                                         {"old_firmware", &B::old_firmware},
                                         {"boundary", &B::boundary, {"plain", "dashed", "quoted", "tight"}},
                                         {"length", &B::length, {"right", "missing", "short", "long", "text", "huge"}},
                                         {"line_end", &B::line_end, {"crlf", "lf"}},
                                         {"down", &B::down},
                                         {"mute", &B::mute},
                                         {"stall", &B::stall},
                                         {"unauthorised", &B::unauthorised},
                                         {"html", &B::html},
                                         {"foreign", &B::foreign},
                                         {"garbage", &B::garbage},
                                         {"truncated", &B::truncated},
                                         {"endless_head", &B::endless_head},
                                         {"endless_part", &B::endless_part},
                                         {"huge_head", &B::huge_head},
                                         {"status", &B::status},
                                         {"stall_after", &B::stall_after},
                                         {"close_after", &B::close_after},
                                         {"cut_after", &B::cut_after},
                                         {"bytes_per_s", &B::bytes_per_s},
                                         {"redirect", &B::redirect}};
    return table;
}

const Word& word(const std::string& name)
{
    const auto found = std::ranges::find_if(words(), [&](const Word& one) { return one.name == name; });
    if (found != words().end())
        return *found;
    std::string all;
    for (const auto& one : words())
        all += std::string(" ") + one.name;
    throw std::invalid_argument("there is no " + name + "; there are:" + all);
}

int number(const std::string& name, const std::string& text)
{
    int value = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem != std::errc() || end != text.data() + text.size())
        throw std::invalid_argument(name + " is a number");
    return value;
}

bool flag(const std::string& name, const std::string& text)
{
    if (text != "on" && text != "off")
        throw std::invalid_argument(name + " is on or off");
    return text == "on";
}

const std::string& choice(const Word& one, const std::string& text)
{
    std::string all;
    for (const auto& allowed : one.choices)
        all += " " + allowed;
    if (!one.choices.empty() && std::ranges::find(one.choices, text) == one.choices.end())
        throw std::invalid_argument(std::string(one.name) + " is one of" + all);
    return text;
}

}  // namespace

void Behaviour::set(const std::string& name, const std::string& value)
{
    const Word& one = word(name);
    if (const auto* integer = std::get_if<int Behaviour::*>(&one.member))
        this->** integer = number(name, value);
    else if (const auto* yes = std::get_if<bool Behaviour::*>(&one.member))
        this->** yes = flag(name, value);
    else
        this->*std::get<std::string Behaviour::*>(one.member) = choice(one, value);
}

std::string Behaviour::text() const
{
    std::string all;
    for (const auto& one : words()) {
        all += std::string(one.name) + "=";
        if (const auto* integer = std::get_if<int Behaviour::*>(&one.member))
            all += std::to_string(this->**integer);
        else if (const auto* yes = std::get_if<bool Behaviour::*>(&one.member))
            all += this->**yes ? "on" : "off";
        else
            all += this->*std::get<std::string Behaviour::*>(one.member);
        all += "\n";
    }
    return all;
}

LoginRules Behaviour::login() const
{
    const Policy policy = auth == "basic"          ? Policy::basic
                          : auth == "digest"       ? Policy::digest
                          : auth == "basic_digest" ? Policy::basic_digest
                                                   : Policy::none;
    return {policy, qop, nonce_uses};
}

}  // namespace axis::emulator
