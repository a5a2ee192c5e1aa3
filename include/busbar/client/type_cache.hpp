#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/client/operation.hpp>
#include <busbar/core/api.hpp>

namespace busbar::client {

/// What is taken from a server, which may describe types without end.
struct TypeCacheLimits {
    /// DataTypes that are kept, with those that only have no definition.
    std::size_t max_types{5'000};
    /// Encodings that are kept for which the server has no DataType.
    std::size_t max_unknown_encodings{5'000};
    /// Steps from a type to the types of its fields and its supertype; also how often values are
    /// looked at again for structures that only became readable by what was learned.
    std::size_t max_steps{50};
    /// Structures of one call of learn_values() that are looked at.
    std::size_t max_structures{100'000};
    binary::DynamicTypeLimits definitions;
};

/// The DataTypes of a server as far as they were needed, from their DataTypeDefinition (Part 3,
/// 5.8.3), or for enumerations of older servers from EnumStrings and EnumValues. Structures that a
/// server does not describe stay encoded.
///
/// Forgets everything when the ServerInfo's revision changes, as the namespaces may have other
/// indices then. One thread; the Requester must outlive it and its operations.
class BUSBAR_API TypeCache {
public:
    explicit TypeCache(Requester& requester, TypeCacheLimits limits = {});
    TypeCache(const TypeCache&) = delete;
    TypeCache& operator=(const TypeCache&) = delete;
    ~TypeCache();

    /// What is known now, never null. A snapshot: DynamicValues that were decoded with it are valid
    /// as long as it is held.
    [[nodiscard]] std::shared_ptr<const binary::DynamicTypes> types() const;

    /// Asks for those of the DataTypes that are not known, and for all that they need. `done` is
    /// called when types() has them, or the server does not describe them.
    Operation learn(std::vector<NodeId> data_types, std::function<void()> done,
                    const ServiceOptions& options = {});
    /// Asks for the types of all structures in the values, also of those within others.
    Operation learn_values(std::vector<Variant> values, std::function<void()> done,
                           const ServiceOptions& options = {});

    struct State;

private:
    std::shared_ptr<State> state_;
};

} // namespace busbar::client
