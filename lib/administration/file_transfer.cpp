#include <busbar/administration/file_transfer.hpp>

namespace busbar::administration {

Result<std::vector<std::byte>> TransferOwner::generate(const TransferRequest&, std::size_t)
{
    return fail(status::Bad_NotSupported);
}

StatusCode TransferOwner::may_take(const TransferRequest&)
{
    return status::Bad_NotSupported;
}

StatusCode TransferOwner::take(const TransferRequest&, std::span<const std::byte>)
{
    return status::Bad_NotSupported;
}

} // namespace busbar::administration
