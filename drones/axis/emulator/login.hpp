// The camera's side of basic and digest authentication (RFC 7617, RFC 2617 with and without qop).
#pragma once

#include "credentials.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace axis::emulator {

/// Which schemes the camera offers.
enum class Policy { none, basic, digest, basic_digest };

struct LoginRules {
    Policy policy = Policy::none;
    bool qop = true;
    int nonce_uses = 0;  ///< a nonce is stale after this many; 0: never
};

/// The hexadecimal response of a digest. @param qop  with nc and cnonce; empty: the form without
std::string digest_response(const Credentials& who, std::string_view realm, std::string_view nonce,
                            std::string_view method, std::string_view uri, std::string_view nc = {},
                            std::string_view cnonce = {}, std::string_view qop = {});

class Login {
public:
    Login(Credentials owner, std::string serial) : owner_(std::move(owner)), realm_("AXIS_" + std::move(serial)) {}

    enum class Verdict { welcome, unknown, wrong, stale };

    /// @param authorization  the header field; empty if there is none
    Verdict check(const LoginRules& rules, std::string_view method, std::string_view uri,
                  std::string_view authorization);
    /// The WWW-Authenticate fields that a 401 carries.
    std::vector<std::string> challenges(const LoginRules& rules, Verdict verdict);

private:
    Verdict check_digest(const LoginRules& rules, std::string_view method, std::string_view uri,
                         std::string_view fields);
    void renew_nonce();

    Credentials owner_;
    std::string realm_, nonce_;
    int uses_ = 0;
    unsigned made_ = 0;
};

}  // namespace axis::emulator
