#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <busbar/binary/type_registry.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/types/data_types.hpp>

#include "server/data/data_call.hpp"

namespace busbar::server::detail {

/// Is notified of an EURange that a data source has.
class EuRangeUser {
public:
    /// `range` is empty if the source has none. The read may be destroyed by this call.
    virtual void eu_range_came(const std::optional<Range>& range) = 0;

protected:
    ~EuRangeUser() = default;
};

/// Returns the property EURange of a Variable (Part 8, 5.3.2.2), no_node if it has none.
[[nodiscard]] model::NodeIndex find_eu_range(const model::AddressSpace& space,
                                             model::NodeIndex variable);

/// Reads the value of an EURange from a data source. Nothing waits for it: as long as the source
/// does not answer nothing happens. Destroying it ends that.
class EuRangeRead final : private SourceCallOwner {
public:
    EuRangeRead(EuRangeUser& user, DataSources& sources) : user_{&user}, call_{sources, 1} {}

    /// Notifies the user at once, or when the answer arrives.
    void start(const model::VariableAttributes& property, TimePoint now);

private:
    void call_completed() override;

    EuRangeUser* user_;
    SourceRead call_;
};

} // namespace busbar::server::detail
