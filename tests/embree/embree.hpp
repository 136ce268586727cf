// Embree as the path tracer's intersector. Written for Embree 3 (Debian's libembree-dev); it also compiles with Embree
// 4, whose header it prefers if both are there.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "pathtracer/intersector.hpp"
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace harness {

// Both are counted by Embree; the last owner frees them.
struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
template <class Handle> using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release>;

// Geometry is copied: Embree's scene holds one geometry for each kind of primitive that there is, still or moving.
class EmbreeIntersector final : public demo::Intersector {
public:
    explicit EmbreeIntersector(const demo::Geometry &geometry) : geometry_(geometry), device_(rtcNewDevice(nullptr))
    {
        if (!device_)
            throw std::runtime_error("Embree cannot start (error " + std::to_string(rtcGetDeviceError(nullptr)) +
                                     "); does the processor have SSE2?");
        // Rays have grown with minor versions: a library of another one writes past them.
        const auto version = rtcGetDeviceProperty(device_.get(), RTC_DEVICE_PROPERTY_VERSION);
        if (version / 100 != RTC_VERSION / 100)
            throw std::runtime_error("this was compiled with Embree " RTC_VERSION_STRING ", but runs with version " +
                                     std::to_string(version) +
                                     " (of the form 30000 for 3.0.0): install headers and library of the same release");
        scene_.reset(rtcNewScene(device_.get()));
        // Without it, rays may slip through the edges between triangles.
        rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
        std::vector<uint32_t> still, moving;
        for (uint32_t i = 0; i < geometry.triangles.size(); ++i)
            (moves(geometry.triangles[i].motion) ? moving : still).push_back(i);
        add_triangles(std::move(still), 1);
        add_triangles(std::move(moving), 2);
        add_spheres();
        rtcCommitScene(scene_.get());
        check("build its tree");
    }

    bool closest(const demo::Ray &ray, demo::Hit &hit) const override
    {
        RTCRayHit query;
        query.ray = embree_ray(ray, std::numeric_limits<float>::infinity());
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
        rtcIntersect1(scene_.get(), &query);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(scene_.get(), &context, &query);
#endif
        const RTCHit &found = query.hit;
        if (found.geomID == RTC_INVALID_GEOMETRY_ID)
            return false;
        hit.distance = query.ray.tfar;
        if (found.geomID < triangles_.size())
            describe(geometry_.triangles[triangles_[found.geomID][found.primID]], found.u, found.v, hit);
        else
            describe(geometry_.spheres[found.primID], ray, hit);
        // Embree's own, so that agreement with the other tree says something of both.
        hit.geometric = demo::normalize({found.Ng_x, found.Ng_y, found.Ng_z});
        return true;
    }

    bool occluded(const demo::Ray &ray, float distance) const override
    {
        if (!(distance > 0))
            return false; // Embree would report a hit by a negative end, too
        RTCRay query = embree_ray(ray, distance);
#if RTC_VERSION_MAJOR >= 4
        rtcOccluded1(scene_.get(), &query);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcOccluded1(scene_.get(), &context, &query);
#endif
        return query.tfar < 0; // Embree's sign of a hit
    }

private:
    static bool moves(demo::Vector motion) { return !demo::black(motion); }

    static RTCRay embree_ray(const demo::Ray &ray, float distance)
    {
        RTCRay query;
        query.org_x = ray.origin.x;
        query.org_y = ray.origin.y;
        query.org_z = ray.origin.z;
        query.dir_x = ray.direction.x;
        query.dir_y = ray.direction.y;
        query.dir_z = ray.direction.z;
        query.tnear = 0;
        query.tfar = distance;
        query.time = ray.time;
        query.mask = ~0u;
        query.id = 0;
        query.flags = 0;
        return query;
    }

    void check(const char *what) const
    {
        RTCError error = rtcGetDeviceError(device_.get());
        if (error != RTC_ERROR_NONE)
            throw std::runtime_error(std::string("Embree cannot ") + what + " (error " + std::to_string(error) +
                                     (error == RTC_ERROR_OUT_OF_MEMORY ? ": out of memory)" : ")"));
    }

    template <class Element>
    Element *buffer(RTCGeometry geometry, RTCBufferType type, unsigned slot, RTCFormat format, size_t count) const
    {
        void *memory = rtcSetNewGeometryBuffer(geometry, type, slot, format, sizeof(Element), count);
        check("hold the geometry");
        return static_cast<Element *>(memory);
    }

    void attach(RTCGeometry geometry)
    {
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_.get(), geometry);
        rtcReleaseGeometry(geometry);
        check("take the geometry");
    }

    // `steps`: 1 for what stands still, 2 for what moves on a line.
    void add_triangles(std::vector<uint32_t> members, unsigned steps)
    {
        if (members.empty())
            return;
        struct Corners {
            uint32_t index[3];
        };
        RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetGeometryTimeStepCount(geometry, steps);
        for (unsigned step = 0; step < steps; ++step) {
            auto *corner =
                buffer<demo::Vector>(geometry, RTC_BUFFER_TYPE_VERTEX, step, RTC_FORMAT_FLOAT3, 3 * members.size());
            for (uint32_t member : members) {
                const demo::Triangle &triangle = geometry_.triangles[member];
                for (demo::Vector point : triangle.corner)
                    *corner++ = point + static_cast<float>(step) * triangle.motion;
            }
        }
        auto *corners = buffer<Corners>(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, members.size());
        for (uint32_t i = 0; i < members.size(); ++i)
            corners[i] = {{3 * i, 3 * i + 1, 3 * i + 2}};
        attach(geometry);
        triangles_.push_back(std::move(members));
    }

    // The last geometry, if there are any.
    void add_spheres()
    {
        const std::vector<demo::Sphere> &spheres = geometry_.spheres;
        if (spheres.empty())
            return;
        struct Ball {
            demo::Vector center;
            float radius;
        };
        RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_SPHERE_POINT);
        rtcSetGeometryTimeStepCount(geometry, 2);
        for (unsigned step = 0; step < 2; ++step) {
            auto *ball = buffer<Ball>(geometry, RTC_BUFFER_TYPE_VERTEX, step, RTC_FORMAT_FLOAT4, spheres.size());
            for (const demo::Sphere &sphere : spheres)
                *ball++ = {sphere.center + static_cast<float>(step) * sphere.motion, sphere.radius};
        }
        attach(geometry);
    }

    const demo::Geometry &geometry_;
    Owned<RTCDevice> device_;
    Owned<RTCScene> scene_;
    std::vector<std::vector<uint32_t>>
        triangles_; // of each of Embree's geometries but the spheres': indices into geometry_
};

} // namespace harness
