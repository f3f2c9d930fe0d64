// A visitor of a variant with one function per case.
#pragma once

namespace hive {

template <class... Cases>
struct Each : Cases... {
    using Cases::operator()...;
};
template <class... Cases>
Each(Cases...) -> Each<Cases...>;  // for clang 14

}  // namespace hive
