// Writes, reads and verifies TXT records.
#include <hive/discovery/announcement.hpp>

#include <hive/name.hpp>
#include <hive/transport/address.hpp>

#include <algorithm>
#include <charconv>
#include <map>
#include <string_view>
#include <tuple>

namespace hive::discovery {
namespace {

constexpr std::size_t most_strings = 16, proof_digits = 32;
constexpr std::string_view version = "1", local_domain = ".local";

bool is_digit_of_hex(char letter) { return (letter >= '0' && letter <= '9') || (letter >= 'a' && letter <= 'f'); }

/// Is the text a valid fingerprint or proof?
bool is_digits(std::string_view text)
{
    return text.size() == proof_digits && std::ranges::all_of(text, is_digit_of_hex);
}

/// IPv4 and IPv6 addresses, and DNS names.
bool is_host(std::string_view text)
{
    const auto fits = [](char letter) {
        return (letter >= '0' && letter <= '9') || (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z')
               || letter == '-' || letter == '_' || letter == '.' || letter == ':';
    };
    return !text.empty() && text.size() <= 253 && text.front() != '-' && text.front() != '.'
           && std::ranges::all_of(text, fits);
}

/// The first value of each key counts (RFC 6763, 6.4).
std::map<std::string, std::string> fields_of(const std::vector<std::string>& txt)
{
    std::map<std::string, std::string> fields;
    for (const auto& text : txt)
        if (const auto equals = text.find('='); equals != std::string::npos)
            fields.emplace(text.substr(0, equals), text.substr(equals + 1));
    return fields;
}

/// "DIGITS,DIGITS" up to the maximum number; nothing for any other text.
std::optional<std::vector<std::string>> digits_in(const std::string& text)
{
    std::vector<std::string> all;
    for (std::size_t from = 0; from <= text.size(); from += proof_digits + 1) {
        all.push_back(text.substr(from, std::min(text.find(',', from), text.size()) - from));
        if (!is_digits(all.back()) || all.size() > Announcement::most_proofs)
            return std::nullopt;
    }
    return all;
}

std::optional<std::vector<KeyProof>> proofs_in(std::map<std::string, std::string>& fields)
{
    const auto fingerprints = digits_in(fields["key"]);
    const auto proofs = digits_in(fields["proof"]), of_members = digits_in(fields["members"]);
    if (!fingerprints || !proofs || !of_members || fingerprints->size() != proofs->size()
        || fingerprints->size() != of_members->size())
        return std::nullopt;
    std::vector<KeyProof> all;
    for (std::size_t i = 0; i < fingerprints->size(); ++i)
        all.push_back({(*fingerprints)[i], (*proofs)[i], (*of_members)[i]});
    return all;
}

std::string joined(const std::vector<KeyProof>& proofs, std::string KeyProof::*part)
{
    std::string text;
    for (const auto& proof : proofs)
        text += (text.empty() ? "" : ",") + proof.*part;
    return text;
}

std::optional<std::int64_t> epoch_in(const std::string& text)
{
    std::int64_t epoch = 0;
    const auto* end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, epoch);
    if (read.ec != std::errc() || read.ptr != end || epoch <= 0)
        return std::nullopt;
    return epoch;
}

bool is_dialable(const transport::Address& address)
{
    return address.scheme == transport::Address::Scheme::tcp && address.port != 0 && is_host(address.host)
           && !address.is_everywhere();
}

/// Throws Errc::invalid_argument for an invalid address.
bool is_place(const std::string& text) { return text.empty() || is_dialable(transport::parse_address(text)); }

bool is_loopback(const std::string& host) { return host.starts_with("127.") || host == "::1" || host == "localhost"; }

/// "cam1" of "cam1.local".
std::string short_name(std::string host)
{
    if (host.ends_with(local_domain))
        host.resize(host.size() - local_domain.size());
    return host;
}

/// The text that a proof covers: no part of it can be announced by another machine.
std::string proved_text(const Announcement& said, const Service& service)
{
    return said.drone + "\n" + said.kind + "\n" + std::to_string(said.epoch) + "\n" + said.at + "\n"
           + short_name(service.host) + "\n" + std::to_string(service.port);
}

/// Rates an address; higher is better.
int worth(const Neighbour& neighbour)
{
    const auto host = transport::parse_address(neighbour.address).host;
    if (is_loopback(host))
        return 0;
    return host.find(':') == std::string::npos ? 2 : 1;  // a drone at all addresses may listen for IPv4 only
}

auto identity(const Neighbour& neighbour) { return std::tie(neighbour.said.drone, neighbour.host, neighbour.port); }

}  // namespace

void prove(Announcement& announcement, const Service& service, const std::vector<SwarmKey>& keys)
{
    announcement.proofs.clear();
    const auto text = proved_text(announcement, service);
    for (const auto& key : keys)
        if (announcement.proofs.size() < Announcement::most_proofs)
            announcement.proofs.push_back(
                {.fingerprint = announced_fingerprint(key),
                 .proof = announcement_proof(key.role == Role::member ? viewers_key(key) : key, text),
                 .members_proof = announcement_proof(key, text)});
}

bool is_proved(const Announcement& announcement, const Service& service, const std::vector<SwarmKey>& keys)
{
    for (const auto& key : keys) {
        const auto own = announced_fingerprint(key);
        for (const auto& [fingerprint, proof, members_proof] : announcement.proofs)
            if (fingerprint == own)
                return (key.role == Role::member ? members_proof : proof)
                       == announcement_proof(key, proved_text(announcement, service));
    }
    return false;
}

std::vector<std::string> to_txt(const Announcement& announcement)
{
    std::vector<std::string> txt{"txtvers=" + std::string(version),
                                 "name=" + announcement.drone,
                                 "kind=" + announcement.kind,
                                 "epoch=" + std::to_string(announcement.epoch),
                                 "key=" + joined(announcement.proofs, &KeyProof::fingerprint),
                                 "proof=" + joined(announcement.proofs, &KeyProof::proof),
                                 "members=" + joined(announcement.proofs, &KeyProof::members_proof)};
    if (!announcement.at.empty())
        txt.push_back("at=" + announcement.at);
    return txt;
}

std::optional<Announcement> from_txt(const std::vector<std::string>& txt)
try {
    if (txt.size() > most_strings)
        return std::nullopt;
    auto fields = fields_of(txt);
    const auto proofs = proofs_in(fields);
    const auto epoch = epoch_in(fields["epoch"]);
    if (fields["txtvers"] != version || !is_name(fields["name"]) || !is_name(fields["kind"]) || !proofs || !epoch
        || !is_place(fields["at"]))
        return std::nullopt;
    return Announcement{
        .drone = fields["name"], .kind = fields["kind"], .epoch = *epoch, .at = fields["at"], .proofs = *proofs};
} catch (const Error&) {
    return std::nullopt;
}

std::optional<Spot> announced_spot(const std::vector<std::string>& listen, const std::vector<std::string>& advertise)
{
    for (const auto& text : advertise.empty() ? listen : advertise) {
        const auto address = transport::parse_address(text);
        if (address.scheme != transport::Address::Scheme::tcp || is_loopback(address.host))
            continue;
        return Spot{.port = address.port, .at = address.is_everywhere() ? "" : text};
    }
    return std::nullopt;
}

std::optional<Neighbour> neighbour(const Announcement& said, const Service& service, const std::string& address,
                                   bool same_machine)
{
    const auto& [host, port] = service;
    const transport::Address found = said.at.empty()
                                         ? transport::Address{transport::Address::Scheme::tcp, address, port}
                                         : transport::parse_address(said.at);
    const auto name = said.at.empty() ? short_name(host) : found.host;
    if (!is_dialable(found) || !is_host(name))
        return std::nullopt;
    return Neighbour{.said = said,
                     .host = name == "local" ? found.host : name,  // the name of this machine in swarm files
                     .address = to_text(found),
                     .port = found.port,
                     .same_machine = same_machine};
}

std::vector<Neighbour> without_repetitions(std::vector<Neighbour> neighbours)
{
    std::ranges::sort(neighbours, [](const Neighbour& one, const Neighbour& other) {
        const auto at_one = identity(one), at_other = identity(other);
        if (at_one != at_other)
            return at_one < at_other;
        return std::tuple(one.said.epoch, worth(one), one.address)
               > std::tuple(other.said.epoch, worth(other), other.address);
    });
    const auto same = [](const Neighbour& one, const Neighbour& other) { return identity(one) == identity(other); };
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end(), same), neighbours.end());
    return neighbours;
}

}  // namespace hive::discovery
