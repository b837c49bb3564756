use super::*;

fn closed_and_convex(p: &Polytope) {
    for (f, (n, offset)) in p.planes.iter().enumerate() {
        assert!((n.length() - 1.0).abs() < 1e-6);
        for v in p.vertices {
            assert!(n.dot(*v) <= offset + 1e-6);
        }
        let face = p.face(f);
        let at = |i: usize| p.vertices[usize::from(face[i % face.len()])];
        for i in 0..face.len() {
            assert!((n.dot(at(i)) - offset).abs() < 1e-6);
            assert!((at(i + 1) - at(i)).cross(at(i + 2) - at(i + 1)).dot(*n) >= -1e-6);
        }
    }
    for e in p.edges {
        let has = |f: u16, a: u16, b: u16| {
            let face = p.face(usize::from(f));
            (0..face.len()).any(|i| face[i] == a && face[(i + 1) % face.len()] == b)
        };
        let [a, b] = e.vertices;
        assert!(has(e.faces[0], a, b) && has(e.faces[1], b, a), "{e:?}");
    }
    assert_eq!(p.vertices.len() + p.planes.len(), p.edges.len() + 2);
}

#[test]
fn boxes_and_triangles_are_closed_and_wind_outwards() {
    closed_and_convex(&Solid::Box(Brick::new(Vec3::new(1.0, 2.0, 0.5))).view());
    let corners = [Vec3::ZERO, Vec3::X, Vec3::new(0.3, 0.4, 0.9)];
    for eye in [Vec3::Y * 3.0, Vec3::NEG_Y * 3.0] {
        let triangle = Triangle::facing(corners, eye).unwrap();
        assert!(triangle.normal().dot(eye) > 0.0);
        closed_and_convex(&Solid::Triangle(triangle).view());
    }
    assert!(Triangle::facing([Vec3::ZERO, Vec3::X, Vec3::X * 2.0], Vec3::Y).is_none());
    assert!(Triangle::facing([Vec3::ZERO; 3], Vec3::Y).is_none());
}
