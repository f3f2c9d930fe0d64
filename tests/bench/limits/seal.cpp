// OpenSSL's calls for one record, as its own sessions make them.
#include "seal.hpp"

#include <algorithm>
#include <array>
#include <openssl/evp.h>
#include <stdexcept>

namespace hive::bench {
namespace {

unsigned char* bytes_of(std::byte* bytes) { return reinterpret_cast<unsigned char*>(bytes); }
const unsigned char* bytes_of(const std::byte* bytes) { return reinterpret_cast<const unsigned char*>(bytes); }

void require(int result)
{
    if (result != 1)
        throw std::runtime_error("OpenSSL refuses AES-128-GCM");
}

}  // namespace

struct Seal::Cipher {
    std::unique_ptr<EVP_CIPHER_CTX, decltype(&::EVP_CIPHER_CTX_free)> context{::EVP_CIPHER_CTX_new(),
                                                                              ::EVP_CIPHER_CTX_free};
    std::array<unsigned char, 12> number{};
    bool encrypts = false;

    void begin()
    {
        for (auto digit = number.rbegin(); digit != number.rend() && ++*digit == 0; ++digit) {
        }
        require(::EVP_CipherInit_ex(context.get(), nullptr, nullptr, nullptr, number.data(), encrypts));
    }
    int work(const std::byte* from, std::size_t size, std::byte* to)
    {
        int done = 0;
        require(::EVP_CipherUpdate(context.get(), bytes_of(to), &done, bytes_of(from), static_cast<int>(size)));
        unsigned char none[16];
        return ::EVP_CipherFinal_ex(context.get(), none, &done);
    }
};

Seal::Seal(bool encrypts) : cipher_(std::make_unique<Cipher>())
{
    const std::unique_ptr<EVP_CIPHER, decltype(&::EVP_CIPHER_free)> cipher(
        ::EVP_CIPHER_fetch(nullptr, "AES-128-GCM", nullptr), ::EVP_CIPHER_free);
    constexpr std::array<unsigned char, 16> key{'n', 'o', ' ', 's', 'e', 'c', 'r', 'e', 't'};
    cipher_->encrypts = encrypts;
    require(::EVP_CipherInit_ex(cipher_->context.get(), cipher.get(), nullptr, key.data(), cipher_->number.data(),
                                encrypts));
}

Seal::~Seal() = default;

void Seal::close(std::span<const std::byte> frame, std::byte* to)
{
    while (!frame.empty()) {
        const auto size = std::min(record, frame.size());
        cipher_->begin();
        require(cipher_->work(frame.data(), size, to));
        require(::EVP_CIPHER_CTX_ctrl(cipher_->context.get(), EVP_CTRL_AEAD_GET_TAG, tag, to + size));
        frame = frame.subspan(size);
        to += size + tag;
    }
}

bool Seal::open(std::span<const std::byte> sealed, std::span<std::byte> frame)
{
    bool good = true;
    while (good && !frame.empty()) {
        const auto size = std::min(record, frame.size());
        cipher_->begin();
        auto* of_record = const_cast<std::byte*>(sealed.data() + size);
        require(::EVP_CIPHER_CTX_ctrl(cipher_->context.get(), EVP_CTRL_AEAD_SET_TAG, tag, of_record));
        good = cipher_->work(sealed.data(), size, frame.data()) == 1;
        frame = frame.subspan(size);
        sealed = sealed.subspan(size + tag);
    }
    return good;
}

}  // namespace hive::bench
