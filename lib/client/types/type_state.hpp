#pragma once

#include <set>
#include <unordered_map>
#include <vector>

#include <busbar/client/type_cache.hpp>

namespace busbar::client {

/// What a TypeCache has, shared with its operations.
struct TypeCache::State {
    State(Requester& r, const TypeCacheLimits& l) : requester{r}, limits{l} {}

    /// Forgets what another namespace table was the base of.
    void check_revision();
    void add(binary::DataTypeEntry entry);
    /// The types of all entries.
    [[nodiscard]] std::shared_ptr<const binary::DynamicTypes> compiled();
    [[nodiscard]] bool has_room() const { return entries.size() < limits.max_types; }

    Requester& requester;
    TypeCacheLimits limits;
    std::uint64_t revision{0};
    std::unordered_map<NodeId, binary::DataTypeEntry> entries;
    /// Encodings that no DataType has.
    std::set<NodeId> unknown_encodings;
    std::shared_ptr<const binary::DynamicTypes> types{
        std::make_shared<const binary::DynamicTypes>()};
    bool is_compiled{true};
};

namespace detail {

/// Finds the encodings of structures in values.
class EncodingSearch {
public:
    EncodingSearch(const binary::DynamicTypes& types, std::size_t max_structures)
        : types_{types}, left_{max_structures}
    {
    }

    void look_at(const Variant& value);
    /// Those that are not among the types.
    [[nodiscard]] std::set<NodeId> take_unknown() { return std::move(unknown_); }

private:
    void look_at(const ExtensionObject& object);
    void look_at(const binary::DynamicValue& value);

    static constexpr std::size_t max_depth = 100;

    const binary::DynamicTypes& types_;
    std::size_t left_;
    std::size_t depth_{0};
    std::set<NodeId> unknown_;
};

} // namespace detail

} // namespace busbar::client
