// Indices of pixels of images and of rays of views. The includer's push constants have width, height and views of the
// images, and tiles_across and tiles_down of a view's rays.
#ifndef NEUVV_IMAGE_PIXEL_GLSL
#define NEUVV_IMAGE_PIXEL_GLSL

// The index of a view's ray in the buffers.
int ray_at(uint view, uvec2 at) {
    const uvec2 tile = at / kTile, inner = at % kTile;
    const uint first = (view * push.tiles_down + tile.y) * push.tiles_across + tile.x;
    return int(first * kTilePixels + inner.y * kTile + inner.x);
}

// The pixel of this thread. Returns false where it lies beyond the image's edge, or where the dispatch rounded the
// number of groups up. `group` is an index among the tiles of all images.
bool pixel_of_thread(uint group, out uint view, out uvec2 pixel) {
    const uint across = (push.width + kTile - 1u) / kTile, down = (push.height + kTile - 1u) / kTile;
    const uint lane = gl_LocalInvocationID.x, tile = group % (across * down);
    view = group / (across * down);
    pixel = kTile * uvec2(tile % across, tile / across) + uvec2(lane % kTile, lane / kTile);
    return view < push.views && pixel.x < push.width && pixel.y < push.height;
}

#endif
