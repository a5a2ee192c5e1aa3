#include "view_part.hpp"

#include <algorithm>

namespace busbar::server::detail {

ViewPart& ViewPart::of(Session& session)
{
    if (session.view == nullptr) {
        session.view = std::make_unique<ViewPart>();
    }
    return static_cast<ViewPart&>(*session.view);
}

Result<ByteString> ViewPart::add(Session& session, crypto::Random& random, const BrowseState& state,
                                 std::size_t most)
{
    if (points_.size() >= most) {
        if (points_.empty() || points_.front().request == request_) {
            return fail(status::Bad_NoContinuationPoints);
        }
        points_.erase(points_.begin());
        session.release(sizeof(Point));
    }
    Point point{{}, request_, state};
    if (!random.fill(point.id) || !session.charge(sizeof(Point))) {
        return fail(status::Bad_NoContinuationPoints);
    }
    points_.push_back(point);
    return ByteString{std::span<const std::byte>{point.id}};
}

Result<BrowseState> ViewPart::take(Session& session, const ByteString& id)
{
    const auto bytes = id.span();
    const auto found = std::find_if(points_.begin(), points_.end(), [&](const Point& point) {
        return std::equal(point.id.begin(), point.id.end(), bytes.begin(), bytes.end());
    });
    if (found == points_.end()) {
        return fail(status::Bad_ContinuationPointInvalid);
    }
    const BrowseState state = found->state;
    points_.erase(found);
    session.release(sizeof(Point));
    return state;
}

} // namespace busbar::server::detail
