#pragma once

#include <memory>
#include <string>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>

#include "server/attribute/read_job.hpp"
#include "server/attribute/write_job.hpp"

namespace busbar::test {

class FixedClock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override { return time; }
    DateTime time{DateTime::from_unix_seconds(1'000)};
};

struct CountingOwner final : server::detail::SourceCallOwner {
    int completed{0};
    void call_completed() override { ++completed; }
};

/// Keeps its batches; cuts ranges by itself if told so.
class KeepingSource final : public server::DataSource {
public:
    server::DataSourceOptions options() const override { return options_; }
    void read(server::ReadBatch batch) override { reads.push_back(std::move(batch)); }
    void write(server::WriteBatch batch) override { writes.push_back(std::move(batch)); }

    server::DataSourceOptions options_;
    std::vector<server::ReadBatch> reads;
    std::vector<server::WriteBatch> writes;
};

/// An address space with variables of a memory source, and what Read and Write need besides.
class AttributeFixture {
public:
    AttributeFixture()
    {
        CHECK(sources.add(memory) == 0);
        namespace_index = space.add_namespace("urn:test").value();
    }

    /// A variable of the memory source.
    NodeId add(const char* name, std::uint32_t data_type, Variant value,
               model::Access access_level = model::Access::ReadWrite, std::int32_t value_rank = -1)
    {
        model::NewVariable variable;
        variable.data_type = NodeId{0, data_type};
        variable.value_rank = value_rank;
        variable.access_level = access_level;
        variable.source = 0;
        variable.handle = memory.add(std::move(value));
        return add(name, variable);
    }
    NodeId add(const char* name, const model::NewVariable& variable)
    {
        model::NewNode node;
        node.id = NodeId{namespace_index, name};
        node.browse_name = QualifiedName{namespace_index, name};
        node.parent = space.find(id::ObjectsFolder);
        REQUIRE(space.add_variable(node, variable).has_value());
        return node.id;
    }

    /// A source that lives as long as it must; to be added when its options are set.
    template <typename Source>
    Source& make_source()
    {
        auto source = std::make_unique<Source>();
        Source& made = *source;
        owned_sources.push_back(std::move(source));
        return made;
    }

    struct PlannedRead final : server::detail::ReadJob {
        PlannedRead(AttributeFixture& fixture, const ReadRequest& request)
            : ReadJob{fixture.sources, request}
        {
            server::detail::Turn endless;
            REQUIRE(fixture.plan(*this, endless));
        }
    };
    [[nodiscard]] PlannedRead read_job(const ReadRequest& request) { return {*this, request}; }
    [[nodiscard]] bool plan(server::detail::ReadJob& job, server::detail::Turn& turn)
    {
        const auto no_live_value = [this](const NodeId& node) -> Result<DataValue> {
            if (live.is_null() || node != live) {
                return fail(status::Bad_NodeIdUnknown);
            }
            return DataValue{Variant{42}};
        };
        return job.plan({space, sources, {space, user, control}, no_live_value, server_time}, turn);
    }
    /// The answers as a client decodes them.
    static std::vector<DataValue> results(server::detail::ReadJob& job)
    {
        job.finish();
        binary::VectorSink sink;
        binary::Writer writer{sink};
        job.encode_results(writer, DateTime{});
        const auto bytes = sink.take(writer.written());
        binary::Reader reader{bytes};
        Array<DataValue> values;
        Array<DiagnosticInfo> diagnostics;
        decode(reader, values);
        decode(reader, diagnostics);
        CHECK(reader.ok());
        CHECK(reader.remaining() == 0);
        return {values.begin(), values.end()};
    }
    std::vector<DataValue> read(const ReadRequest& request)
    {
        REQUIRE(server::detail::check_read(request, 1'000'000) == status::Good);
        auto job = read_job(request);
        REQUIRE(job.start(owner, TimePoint{}));
        return results(job);
    }
    DataValue read(const NodeId& node, AttributeId attribute = AttributeId::Value,
                   const char* range = nullptr)
    {
        return read(read_request({read_value_id(node, attribute, range)}))[0];
    }
    static ReadValueId read_value_id(const NodeId& node, AttributeId attribute = AttributeId::Value,
                                     const char* range = nullptr)
    {
        ReadValueId value_id;
        value_id.node_id = node;
        value_id.attribute_id = static_cast<std::uint32_t>(attribute);
        value_id.index_range = range != nullptr ? String{range} : String{};
        return value_id;
    }
    static ReadRequest read_request(std::initializer_list<ReadValueId> ids)
    {
        ReadRequest request;
        request.timestamps_to_return = TimestampsToReturn::Neither;
        request.nodes_to_read = ids;
        return request;
    }

    std::vector<StatusCode> write(const WriteRequest& request)
    {
        REQUIRE(server::detail::check_write(request, 1'000) == status::Good);
        server::detail::WriteJob job{sources, request};
        server::detail::Turn endless;
        REQUIRE(
            job.plan({space, sources, {space, user, control}, definitions, server_time}, endless));
        REQUIRE(job.start(owner, TimePoint{}));
        return results(job);
    }
    static std::vector<StatusCode> results(const server::detail::WriteJob& job)
    {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        job.encode_results(writer);
        const auto bytes = sink.take(writer.written());
        binary::Reader reader{bytes};
        Array<StatusCode> values;
        decode(reader, values);
        return {values.begin(), values.end()};
    }
    StatusCode write(const NodeId& node, DataValue data, const char* range = nullptr,
                     AttributeId attribute = AttributeId::Value)
    {
        WriteRequest request;
        request.nodes_to_write = {write_value(node, std::move(data), range, attribute)};
        return write(request)[0];
    }
    static WriteValue write_value(const NodeId& node, DataValue data, const char* range = nullptr,
                                  AttributeId attribute = AttributeId::Value)
    {
        WriteValue value;
        value.node_id = node;
        value.attribute_id = static_cast<std::uint32_t>(attribute);
        value.index_range = range != nullptr ? String{range} : String{};
        value.value = std::move(data);
        return value;
    }

    FixedClock clock;
    server::MemorySource memory{clock};
    /// Sources outlive the server.
    std::vector<std::unique_ptr<server::DataSource>> owned_sources;
    server::detail::DataSources sources{nullptr};
    model::AddressSpace space;
    model::DataTypes data_types;
    server::detail::DataTypeChecks definitions{space, {}};
    std::uint16_t namespace_index{0};
    server::UserIdentity user;
    const server::AccessControl* control{nullptr};
    NodeId live;
    DateTime server_time{DateTime::from_unix_seconds(2'000)};
    CountingOwner owner;
};

} // namespace busbar::test
