// HKDF and random bytes, by OpenSSL.
#include "key_derivation.hpp"

#include <hive/error.hpp>

#include <openssl/core_names.h>
#include <openssl/kdf.h>
#include <openssl/params.h>
#include <openssl/rand.h>

#include <memory>

namespace hive {

SwarmKey new_swarm_key(std::int64_t now_s)
{
    SwarmKey key;
    if (::RAND_bytes(key.secret.data(), static_cast<int>(key.secret.size())) != 1)
        throw Error(Errc::io, "the operating system provides no random bytes");
    key.id = transport::id_of(key.secret);
    key.created_s = now_s;
    return key;
}

SwarmKey viewers_key(const SwarmKey& members)
{
    if (members.role != Role::member)
        throw Error(Errc::invalid_argument, "a viewers' key is made of a members' key, and this one is a viewers' key");
    SwarmKey viewers = members;
    viewers.role = Role::viewer;
    viewers.secret = transport::derived(members.secret, "hive view v1");
    return viewers;
}

namespace {

/// 32 hexadecimal digits that only a holder of the key can make.
std::string announced(const SwarmKey& key, std::string_view use)
{
    return transport::hex(transport::derived(key.secret, use).data(), 16);
}

}  // namespace

std::string announced_fingerprint(const SwarmKey& key)
{
    return announced(key.role == Role::member ? viewers_key(key) : key, "hive announce v1");
}

std::string announcement_proof(const SwarmKey& key, std::string_view text)
{
    return announced(key, "hive announcement v1\n" + std::string(text));
}

namespace transport {

SwarmKey::Secret derived(const SwarmKey::Secret& secret, std::string_view use)
{
    const std::unique_ptr<EVP_KDF, decltype(&::EVP_KDF_free)> kdf(::EVP_KDF_fetch(nullptr, "HKDF", nullptr),
                                                                  ::EVP_KDF_free);
    const std::unique_ptr<EVP_KDF_CTX, decltype(&::EVP_KDF_CTX_free)> context(::EVP_KDF_CTX_new(kdf.get()),
                                                                              ::EVP_KDF_CTX_free);
    char digest[] = "SHA256";
    const OSSL_PARAM parameters[] = {
        ::OSSL_PARAM_construct_utf8_string(OSSL_KDF_PARAM_DIGEST, digest, 0),
        ::OSSL_PARAM_construct_octet_string(OSSL_KDF_PARAM_KEY, const_cast<unsigned char*>(secret.data()),
                                            secret.size()),
        ::OSSL_PARAM_construct_octet_string(OSSL_KDF_PARAM_INFO, const_cast<char*>(use.data()), use.size()),
        ::OSSL_PARAM_construct_end()};
    SwarmKey::Secret result{};
    if (!context || ::EVP_KDF_derive(context.get(), result.data(), result.size(), parameters) != 1)
        throw Error(Errc::failed, "OpenSSL cannot derive a key by HKDF");
    return result;
}

SwarmKey::Secret tls_secret(const SwarmKey& key) { return derived(key.secret, "hive tls v1"); }

std::string tls_identity(const SwarmKey& key) { return "hive-1-" + std::string(token(key.role)) + "-" + key.id; }

std::string id_of(const SwarmKey::Secret& members) { return hex(derived(members, "hive id v1").data(), 8); }

std::string hex(const unsigned char* bytes, std::size_t size)
{
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text;
    for (std::size_t i = 0; i < size; ++i) {
        text += digits[bytes[i] >> 4];
        text += digits[bytes[i] & 15];
    }
    return text;
}

}  // namespace transport
}  // namespace hive
