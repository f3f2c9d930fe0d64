// Parses the Authorization field of a client and computes the response that is expected.
#include "login.hpp"

#include "md5.hpp"

#include <map>

namespace axis::emulator {
namespace {

/// name=value and name="value", joined by commas.
std::map<std::string, std::string> fields_of(std::string_view text)
{
    std::map<std::string, std::string> fields;
    while (!text.empty()) {
        text.remove_prefix(std::min(text.find_first_not_of(", "), text.size()));
        const std::size_t equals = text.find('=');
        if (equals == std::string_view::npos)
            break;
        const std::string name(text.substr(0, equals));
        text.remove_prefix(equals + 1);
        const bool quoted = text.starts_with('"');
        text.remove_prefix(quoted ? 1 : 0);
        const std::size_t end = std::min(text.find(quoted ? '"' : ','), text.size());
        fields[name] = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return fields;
}

std::string base64(std::string_view text)
{
    constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string result;
    unsigned bits = 0;
    int count = 0;
    for (const char c : text) {
        bits = bits << 8 | static_cast<unsigned char>(c);
        for (count += 8; count >= 6; count -= 6)
            result += letters[bits >> (count - 6) & 63];
    }
    if (count > 0)
        result += letters[bits << (6 - count) & 63];
    result.append((4 - result.size() % 4) % 4, '=');
    return result;
}

bool takes_basic(Policy policy) { return policy == Policy::basic || policy == Policy::basic_digest; }
bool takes_digest(Policy policy) { return policy == Policy::digest || policy == Policy::basic_digest; }

}  // namespace

std::string digest_response(const Credentials& who, std::string_view realm, std::string_view nonce,
                            std::string_view method, std::string_view uri, std::string_view nc, std::string_view cnonce,
                            std::string_view qop)
{
    const auto joined = [](auto... parts) {
        std::string text;
        ((text += text.empty() ? "" : ":", text += parts), ...);
        return text;
    };
    const std::string secret = md5(joined(who.user, realm, who.password)), request = md5(joined(method, uri));
    return md5(qop.empty() ? joined(secret, nonce, request) : joined(secret, nonce, nc, cnonce, qop, request));
}

Login::Verdict Login::check(const LoginRules& rules, std::string_view method, std::string_view uri,
                            std::string_view authorization)
{
    if (rules.policy == Policy::none)
        return Verdict::welcome;
    if (takes_basic(rules.policy) && authorization.starts_with("Basic "))
        return authorization.substr(6) == base64(owner_.user + ":" + owner_.password) ? Verdict::welcome
                                                                                      : Verdict::wrong;
    if (takes_digest(rules.policy) && authorization.starts_with("Digest "))
        return check_digest(rules, method, uri, authorization.substr(7));
    return Verdict::unknown;
}

Login::Verdict Login::check_digest(const LoginRules& rules, std::string_view method, std::string_view uri,
                                   std::string_view text)
{
    auto fields = fields_of(text);
    const bool right = fields["username"] == owner_.user && fields["realm"] == realm_ && fields["uri"] == uri
                       && fields["response"]
                              == digest_response(owner_, realm_, fields["nonce"], method, uri, fields["nc"],
                                                 fields["cnonce"], fields["qop"]);
    if (!right)
        return Verdict::wrong;
    if (fields["nonce"] != nonce_ || (rules.nonce_uses > 0 && uses_ >= rules.nonce_uses))
        return Verdict::stale;
    ++uses_;
    return Verdict::welcome;
}

std::vector<std::string> Login::challenges(const LoginRules& rules, Verdict verdict)
{
    std::vector<std::string> result;
    if (takes_digest(rules.policy)) {
        if (nonce_.empty() || verdict == Verdict::stale)
            renew_nonce();
        result.push_back("Digest realm=\"" + realm_ + "\", nonce=\"" + nonce_ + "\", stale="
                         + (verdict == Verdict::stale ? "TRUE" : "FALSE") + (rules.qop ? ", qop=\"auth\"" : ""));
    }
    if (takes_basic(rules.policy))
        result.push_back("Basic realm=\"" + realm_ + "\"");
    return result;
}

/// It protects no secret: it must be new, but may be guessable.
void Login::renew_nonce()
{
    const std::string number = std::to_string(++made_);
    nonce_ = md5(realm_ + number).substr(0, 8) + "Y" + md5(realm_ + number + "nonce");
    uses_ = 0;
}

}  // namespace axis::emulator
