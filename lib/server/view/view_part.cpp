#include "view_part.hpp"

#include <algorithm>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::server::detail {

ViewPart& ViewPart::of(Session& session)
{
    if (session.view == nullptr) {
        session.view = std::make_unique<ViewPart>();
    }
    return static_cast<ViewPart&>(*session.view);
}

Result<ByteString> ViewPart::add(Session& session, crypto::Random& random,
                                 const model::AddressSpace& space, const BrowseState& state,
                                 std::size_t most)
{
    if (points_.size() >= most) {
        if (points_.empty() || points_.front().request == request_) {
            return fail(status::Bad_NoContinuationPoints);
        }
        points_.pop_front();
        session.release(point_memory);
    }
    std::array<std::byte, id_size> id{};
    if (!random.fill(id) || !session.charge(point_memory)) {
        return fail(status::Bad_NoContinuationPoints);
    }
    busbar::detail::Undo paid{[&] { session.release(point_memory); }};
    ByteString given{std::span<const std::byte>{id}};
    Points made;
    Point& point = made.emplace_back(request_, state);
    point.id = id;
    space.journal().watch(state.node.index, model::NodeAspect::ReferencePositions, point);
    points_.splice(points_.end(), made);
    paid.keep();
    return given;
}

Result<BrowseState> ViewPart::take(Session& session, const ByteString& id, Points& used)
{
    const auto bytes = id.span();
    const auto found = std::find_if(points_.begin(), points_.end(), [&](const Point& point) {
        return std::equal(point.id.begin(), point.id.end(), bytes.begin(), bytes.end());
    });
    if (found == points_.end()) {
        return fail(status::Bad_ContinuationPointInvalid);
    }
    const auto state = found->is_lost ? fail(status::Bad_ContinuationPointInvalid)
                                      : Result<BrowseState>{found->state};
    used.splice(used.end(), points_, found);
    session.release(point_memory);
    return state;
}

void ViewPart::take_back(Session& session, Points& used)
{
    while (!points_.empty() && points_.back().request == request_) {
        points_.pop_back();
        session.release(point_memory);
    }
    for (; !used.empty(); points_.splice(points_.end(), used, used.begin())) {
        if (!session.charge(point_memory)) {
            return used.clear();
        }
        used.front().request = request_;
    }
}

} // namespace busbar::server::detail
