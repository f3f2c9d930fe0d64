// The pool of shared memory: slots, generations, limits.
#include <hive/transport/pool.hpp>

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <cstring>

using hive::Body;
using hive::transport::Pool;
using namespace std::chrono_literals;

namespace {

constexpr std::size_t picture = 100'000;

std::shared_ptr<Pool> pool_of(std::size_t bytes = 64u << 20)
{
    return std::make_shared<Pool>(Pool::Limits{.bytes = bytes, .segment_bytes = 1u << 20});
}

Body filled(Pool& pool, unsigned char with, std::size_t size = picture)
{
    auto loan = pool.loan(size);
    REQUIRE(loan);
    std::memset(loan->data(), with, loan->size());
    return std::move(*loan);
}

}  // namespace

TEST_CASE("pool: the slot that was used last is used next, in a new generation")
{
    const auto pool = pool_of();
    auto first = filled(*pool, 1), second = filled(*pool, 2);
    const auto before = pool->find(second)->slot;
    CHECK(pool->find(first)->slot != before);
    second = {};
    const auto third = filled(*pool, 3);
    const auto after = pool->find(third)->slot;
    CHECK(after.segment == before.segment);
    CHECK(after.index == before.index);
    CHECK(after.generation == before.generation + 1);
    CHECK(first.data()[picture - 1] == 1);
}

TEST_CASE("pool: a part of a body is found where it lies, and a body of ordinary memory is not")
{
    const auto pool = pool_of();
    auto loan = pool->loan(picture);
    REQUIRE(loan);
    const Body part = std::move(*loan).body(5000);
    CHECK(pool->find(part)->size == 5000);
    CHECK(pool->find(part)->offset == 0);
    CHECK_FALSE(pool->find(Body(std::vector<unsigned char>(picture))));
    CHECK_FALSE(pool->find(Body()));
}

TEST_CASE("pool: when every slot is taken the answer is no, it is counted, and a slot that comes back is given again")
{
    const auto pool = pool_of();
    std::vector<Body> held;
    for (int i = 0; i < 8; ++i)
        held.push_back(filled(*pool, 1, 1u << 20));
    CHECK_FALSE(pool->loan(1u << 20));
    CHECK(pool->usage().refused == 1);
    CHECK(pool->usage().slots_in_use == 8);
    CHECK(pool->loan(1000));  // another size has slots of its own
    held.pop_back();
    CHECK(pool->loan(1u << 20));
}

TEST_CASE("pool: no more memory is backed than allowed, nor more than the operating system gives")
{
    const auto small = pool_of(3 * picture);
    const auto one = filled(*small, 1), two = filled(*small, 2);
    CHECK_FALSE(small->loan(picture));
    CHECK(small->usage().backed_bytes <= 3 * picture);

    rlimit before{};
    REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
    const rlimit little{.rlim_cur = 4096, .rlim_max = before.rlim_max};
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &little) == 0);
    const auto short_of_memory = pool_of();
    CHECK_FALSE(short_of_memory->loan(picture));
    ::setrlimit(RLIMIT_FSIZE, &before);
    CHECK(short_of_memory->loan(picture));
}

TEST_CASE("pool: copied in, a body has the same bytes; small ones and those that are there stay where they are")
{
    const auto pool = pool_of();
    const Body ordinary(std::string(picture, 'x')), small(std::string(100, 'x'));
    const Body copy = pool->copied_in(ordinary);
    CHECK(pool->find(copy));
    CHECK(std::memcmp(copy.data(), ordinary.data(), picture) == 0);
    CHECK(pool->copied_in(copy).data() == copy.data());
    CHECK(pool->copied_in(small).data() == small.data());
}

TEST_CASE("pool: a body outlives whoever made the pool; what is kept is kept until then, or until the end")
{
    Body survivor;
    {
        const auto pool = pool_of();
        survivor = filled(*pool, 7);
    }
    CHECK(survivor.data()[0] == 7);

    const auto pool = pool_of();
    pool->keep({filled(*pool, 1)}, Pool::Clock::now() + 1h);
    pool->keep({filled(*pool, 2)}, Pool::Clock::now() + 1h);
    CHECK(pool->usage().slots_in_use == 2);
    pool->end();
    CHECK(pool->usage().slots_in_use == 0);
    pool->keep({filled(*pool, 3)}, Pool::Clock::now() + 1h);
    CHECK(pool->usage().slots_in_use == 0);

    const auto another = pool_of();
    another->keep({filled(*another, 3)}, Pool::Clock::now());
    CHECK(another->loan(picture));
    CHECK(another->usage().slots_in_use == 0);
}
