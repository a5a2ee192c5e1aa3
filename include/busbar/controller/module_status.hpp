#pragma once

#include <cstdint>

#include <busbar/controller/mapped_source.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/data_source.hpp>
#include <busbar/server/server.hpp>

namespace busbar::controller {

/// The values that a module shows in its buffer memory (SH-082679, 8.3, 10.3 and
/// appendix 4), as Variables:
///
/// - TargetDevice1Status (`Un\G8448`), UInt16: 0 unknown, 1 communicating, 2 failing. The
///   manual does not define its values; these are our own.
/// - LabelUpdateRunningStatus (`Un\G8617`), UInt16: 1 while labels are updated.
/// - RevisedSamplingIntervalMinimum (`Un\G12419`), UInt32: milliseconds, 0 without items.
/// - ActualSamplingIntervalMinimum (`Un\G12421`), UInt32: milliseconds, 0 before there are two
///   samples.
///
/// For the server's thread. `source`, `server` and `clock` must stay valid until its last read.
class BUSBAR_API ModuleStatus final : public server::DataSource {
public:
    ModuleStatus(const MappedSource& source, const server::Server& server, const WallClock& clock)
        : source_{&source}, server_{&server}, clock_{&clock}
    {
    }
    void read(server::ReadBatch batch) override;

private:
    [[nodiscard]] Variant value_of(std::uint64_t handle) const;

    const MappedSource* source_;
    const server::Server* server_;
    const WallClock* clock_;
};

/// Adds these Variables below `parent`, in the namespace with that index. `status` must have been
/// added to the server. Errors are those of AddressSpace::add_variable; some Variables may have
/// been added then.
[[nodiscard]] BUSBAR_API Result<void> add_module_status_nodes(model::AddressSpace& space,
                                                              model::NodeIndex parent,
                                                              std::uint16_t namespace_index,
                                                              const ModuleStatus& status);

} // namespace busbar::controller
