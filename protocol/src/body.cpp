// Makes bodies of users' containers.
#include <hive/body.hpp>

namespace hive {
namespace {

template <class Container>
Body share(Container&& container)
{
    auto owner = std::make_shared<const Container>(std::move(container));
    const auto bytes = std::as_bytes(std::span(owner->data(), owner->size()));
    return {bytes, std::move(owner)};
}

}  // namespace

Body::Body(std::vector<unsigned char> bytes) : Body(share(std::move(bytes))) {}
Body::Body(std::string bytes) : Body(share(std::move(bytes))) {}

}  // namespace hive
