// Bodies share their bytes and keep their owner alive.
#include <hive/body.hpp>

#include <doctest/doctest.h>

using hive::Body;

TEST_CASE("body: a vector becomes a body without copying its bytes")
{
    std::vector<unsigned char> bytes{1, 2, 3};
    const auto* const place = bytes.data();
    const Body body(std::move(bytes));
    CHECK_EQ(body.data(), place);
    CHECK_EQ(body.size(), 3u);
    CHECK_EQ(body.data()[2], 3);
}

TEST_CASE("body: copies share one memory")
{
    const Body body(std::string(1000, 'x'));
    const Body copy = body;
    CHECK_EQ(copy.data(), body.data());
    CHECK_EQ(copy.size(), 1000u);
}

TEST_CASE("body: the owner lives until the last copy is gone")
{
    auto owner = std::make_shared<const std::string>("pixels");
    const std::weak_ptr<const std::string> watch = owner;
    std::vector<Body> copies(3, Body(std::as_bytes(std::span(owner->data(), owner->size())), owner));
    owner.reset();
    while (!copies.empty()) {
        CHECK_FALSE(watch.expired());
        CHECK_EQ(std::string(reinterpret_cast<const char*>(copies.back().data()), copies.back().size()), "pixels");
        copies.pop_back();
    }
    CHECK(watch.expired());
}

TEST_CASE("body: one that was moved from is empty and owns nothing")
{
    auto owner = std::make_shared<const std::string>("pixels");
    const std::weak_ptr<const std::string> watch = owner;
    Body first(std::as_bytes(std::span(owner->data(), owner->size())), owner);
    owner.reset();
    Body second = std::move(first);
    CHECK(first.empty());  // NOLINT: what is promised about moved-from bodies
    Body third;
    third = std::move(second);
    CHECK(second.empty());  // NOLINT
    CHECK_EQ(third.size(), 6u);
    third = Body();
    CHECK(watch.expired());
}

TEST_CASE("body: nothing is a body too")
{
    CHECK(Body().empty());
    CHECK(Body(std::string()).empty());
    CHECK(Body(std::vector<unsigned char>()).empty());
}
