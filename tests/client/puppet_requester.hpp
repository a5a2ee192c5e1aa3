#pragma once

#include <algorithm>
#include <vector>

#include <catch2/catch.hpp>

#include "test_requester.hpp"

namespace busbar::test {

/// A Requester whose requests wait until the test takes and answers them, whenever it likes.
class PuppetRequester final : public TestRequester {
public:
    void cancel(client::RequestId id) override
    {
        std::erase_if(waiting_, [&](const Waiting& request) { return request.id == id; });
        TestRequester::cancel(id);
    }
    template <typename Request>
    [[nodiscard]] std::size_t count() const
    {
        return static_cast<std::size_t>(
            std::count_if(waiting_.begin(), waiting_.end(), is<Request>));
    }
    /// The oldest request of its kind; reply() and refuse() are for it.
    template <typename Request>
    [[nodiscard]] Request take()
    {
        const auto found = std::find_if(waiting_.begin(), waiting_.end(), is<Request>);
        REQUIRE(found != waiting_.end());
        binary::Reader reader{found->bytes, binary::Strings::Own, &client::standard_types()};
        NodeId id;
        Request request;
        decode(reader, id);
        decode(reader, request);
        REQUIRE(reader.ok());
        taken_ = found->id;
        waiting_.erase(found);
        return request;
    }
    template <typename Response>
    void reply(const Response& response)
    {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        encode(writer, NodeId{0, Response::binary_encoding_id});
        encode(writer, response);
        answer(taken_, client::ResponseBody{sink.take(writer.written())});
    }
    void refuse(StatusCode status) { answer(taken_, fail(status)); }

private:
    struct Waiting {
        client::RequestId id;
        std::uint32_t type;
        std::vector<std::byte> bytes;
    };

    template <typename Request>
    [[nodiscard]] static bool is(const Waiting& request)
    {
        return request.type == Request::binary_encoding_id;
    }
    void sent(client::RequestId id, const Encode& write) override
    {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        write(writer, RequestHeader{});
        auto bytes = sink.take(writer.written());
        binary::Reader reader{bytes, binary::Strings::Own};
        NodeId type;
        decode(reader, type);
        waiting_.push_back({id, type.numeric(), std::move(bytes)});
    }

    std::vector<Waiting> waiting_;
    client::RequestId taken_{0};
};

} // namespace busbar::test
